#pragma once
// Decides from the result of a solve whether a frame was tracked, and when the track is lost (docs/algorithms.md,
// section 7.9).
#include <cstddef>
#include <cstdint>

#include "pliant/estimator.hpp"

namespace pliant {

/// Image width that lengths in `Tuning`s refer to, px.
inline constexpr float kNominalWidthPx = 320;

/// Result of the last solve of a frame.
struct SolveResult {
  std::uint16_t rows = 0;         ///< points with a usable observation
  std::uint16_t inliers = 0;      ///< rows with weight at the end
  std::uint16_t iterations = 0;   ///< of all solves of the frame
  float rms_px = 0;               ///< of the inliers; of an edge, across it
  float score = 0;                ///< mean correlation of the inliers of cue patch; 0: none has a score
  bool pose_is_observed = false;  ///< the observations determine the pose without the priors
  std::size_t searched = 0;       ///< points that the platform searched for
  std::size_t patches_searched = 0, patch_inliers = 0;  ///< the same of cue patch
};

/// Tuning of the loss of a track (docs/algorithms.md, section 7.9). All are round values, not tuned. With them no frame of the
/// recorded face counts as bad (docs/evaluation.md, section Recorded face), and covered faces are told
/// (tests/system/corruption_test.cpp).
struct TrackMonitorTuning {
  /// Inliers that a tracked frame needs at least, count. Fewer can agree by chance.
  std::uint16_t least_inliers = 8;
  /// Fraction of the points searched for that must be inliers; the same fraction applies to those of cue patch alone,
  /// since frame-to-frame tracking (cue flow) would also track an occluder.
  float least_inlier_fraction = 0.15f;
  /// Largest rms of the inliers, px at an image width of 320; scales with the width. The model error
  /// of a real face is part of it.
  float most_rms_px = 4.0f;
  /// Least mean normalised correlation of the inliers of cue patch. A match needs 0.55 in the last round and 0.45 before
  /// (TemplateMatchTuning): a frame whose matches are mostly the doubtful ones of earlier rounds is bad.
  float least_score = 0.5f;
  /// Largest relative change of the image scale against the expected one. A head does not approach faster.
  float most_scale_change = 0.2f;
  /// Consecutive bad frames after which the track is lost, count: a tenth of a second at 30 frames a second. A single
  /// corrupted frame is then degraded only, and the next one starts from the last good state.
  int lost_after_frames = 3;
};
inline constexpr TrackMonitorTuning kTrackMonitorTuning{};

/// Counts bad frames in a row. Two members, no arena.
class TrackMonitor {
 public:
  /// \param width  of the image, px.
  void start(int width) {
    width_ = width;
    bad_frames_ = 0;
  }
  /// True if a solve's result can be trusted.
  /// \param scale_ratio  image scale found over image scale expected.
  bool is_good(const SolveResult& result, float scale_ratio) const;
  /// Notes a frame. \return tracking after a good frame, degraded or lost after bad ones.
  TrackState add(bool is_good);
  /// Bad frames since the last good one, at most lost_after_frames.
  int bad_frames() const { return bad_frames_; }

 private:
  int width_ = 0, bad_frames_ = 0;
};

}  // namespace pliant
