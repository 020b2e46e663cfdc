#pragma once
/// \file poor_start.hpp
/// A track that began where light left little of the face to be seen (docs/algorithms.md, section 7.15).
#include <cstddef>
#include <cstdint>

#include "pliant/estimator.hpp"
#include "pliant/frame.hpp"
#include "vision/patch_tuning.hpp"

namespace pliant {

/// Tuning of poor starts. Each constant: unit, reason, experiment (docs/experiments.md, Faults).
struct PoorStartTuning {
  /// Fraction of the templates of frame 0 below which a start is poor. Starts in light three times too bright capture 6 to 12 of
  /// 128 on the recorded face and up to 12 of 48 with profile S, the clips without a fault 108 to 127, faces at 0.6 of their size
  /// 52 to 59. With 0.25 one of eight clips was never right again with profile S; faults of the heads 40 to 47 are the same.
  float few_templates = 0.35f;
  /// Ratio of the face's mean grey to that at the start, or its inverse, from which on light counts as
  /// changed. Round value.
  float light_ratio = 1.4f;
  /// Grey levels added to both, so that noise in the dark is no change. Round value.
  float dark_grey = 8;
  /// Grey level from which on a pixel is clipped, and the fraction of the landmarks, clipped at a
  /// poor start, above which light hides the face: the track may then be degraded. Light three times too bright clips 0.53 to 0.79
  /// of them on the recorded face, light 2.4 times too bright 0.32 on a rendered one; none are clipped on faces at 0.4 of
  /// their size, of which few templates are captured, too.
  int clipped_grey = patch::kPatchTuning.highest_grey;
  float most_clipped = 0.25f;
  /// Estimated landmark error up to which such a track is not degraded after all, fraction of the eyes' distance. Chosen on five
  /// people, again on eleven (docs/experiments.md, Poor starts; Expected error).
  float most_sure_error = 0.035f;
  /// Where light hid the face: fraction of the part clipped at the start up to which it has changed, too. Round value.
  float clipped_ratio = 0.5f;
  /// Frames from one measurement of the light to the next, count; and measurements that must show a change: in a row, since one
  /// alone may be a flash; where light hid the face, in all, since light that pulses shows more of it again and again. The face
  /// then is right again within ten frames, the search included. Round values.
  std::uint32_t interval_frames = 2;
  int measurements = 3;
  /// The grey is measured at one landmark in so many, count. Round value.
  std::size_t landmark_step = 4;
};
inline constexpr PoorStartTuning kPoorStartTuning{};

/// A start in light that hides most of the face captures few templates, and is aligned badly. These templates
/// still match when the light has changed, so that nothing else ends the track. This part tells when the light
/// has changed: a new start then sees more.
class PoorStart {
 public:
  /// A track has begun in this frame. \param captured  templates. \param most  templates that a start captures.
  void begin(std::size_t captured, std::size_t most, const FrameView& frame, Estimator& estimator);
  bool is_poor() const { return start_grey_ >= 0; }
  /// Whether so much light hid the face that landmarks may be off by a tenth of the eyes' distance.
  bool is_blinded() const { return clipped_ > kPoorStartTuning.most_clipped; }
  /// Whether they may be, in spite of what alignments estimate. \param landmark_error  their estimate; 0: unknown.
  bool is_doubtful(float landmark_error) const {
    return is_blinded() && !(landmark_error > 0 && landmark_error <= kPoorStartTuning.most_sure_error);
  }
  /// A good frame of the track. \return whether the start was poor and light has changed since.
  bool is_over(const FrameView& frame, Estimator& estimator);

 private:
  float start_grey_ = -1;  // negative: the start was not poor
  float clipped_ = 0;      // fraction of the landmarks at a poor start; 0 else
  std::uint32_t frames_ = 0;  // may wrap around
  int changed_count_ = 0;     // of measurements
};

}  // namespace pliant
