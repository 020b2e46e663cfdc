#pragma once
/// \file tracker.hpp
/// The composition: frames + vision + core -> pose, expression and surface points, frame by frame.
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/corners.hpp"
#include "pliant/estimator.hpp"
#include "pliant/frame.hpp"
#include "pliant/model.hpp"
#include "pliant/patch.hpp"
#include "pliant/pyramid.hpp"
#include "pliant/shift.hpp"

namespace pliant {

/// Capacities; they fix the arena's size. The defaults suit 320 x 240.
struct TrackerLimits {
  std::uint16_t width = 320, height = 240;  ///< of the frames, px
  std::uint16_t patches = 128;              ///< tracked surface patches
  std::uint16_t markers = 0;                ///< followed but never observed
  std::uint16_t vertices = 512;
  std::uint8_t pyramid_levels = 3;
  std::uint8_t patch_window = 11;  ///< px, odd
};

struct TrackerOptions {
  EstimatorOptions estimator;
  const std::uint8_t* is_free = nullptr;  ///< flag a parameter; null: the expressions
  float marker_exclusion_px = 8;  ///< no patch is centred within this distance of a marker in the first frame
  float min_correlation = 0.55f;  ///< with the patch of the first frame, in the last round; 0.1 less before
  float forward_backward_px = 0.7f;  ///< at 320 px of width, for the steps from frame to frame
  std::uint8_t rounds = 2;           ///< of predicting, looking and solving a frame
};

/// Follows one model through a stream of frames of one size. All memory is taken at creation. Each surface patch is
/// compared with what it looked like in the first frame, as the model predicts it to be warped, so that it does not
/// drift; where that fails it is followed from the frame before, for a while and with less weight.
class Tracker {
 public:
  Tracker() = default;
  Tracker(const Tracker&) = delete;
  Tracker& operator=(const Tracker&) = delete;

  void lay_out(Arena& arena, const Model& model, const TrackerLimits& limits);

  /// Starts on `frame` (frame 0) from a known state; patches are captured in it. Markers are image points (px) of this
  /// frame, at most limits.markers of them, cast onto the posed mesh; one that misses takes the nearest surface point.
  /// \return bad_argument, size_mismatch, capacity (markers), too_few_points (no texture to hold on to), or a status of
  ///         Estimator::start. The tracker is then not started.
  Status start(const FrameView& frame, const Camera& camera, const Pose& pose, const float* q,
               Span<const Vec2> markers, const TrackerOptions& options);

  /// The next frame. \return not_started, bad_argument, size_mismatch; the state is then as before.
  Status update(const FrameView& frame, FrameResult* result);

  /// Of the last frame; after `start` that of frame 0: tracking, at the pose given.
  const FrameResult& result() const { return result_; }
  Estimator& estimator() { return estimator_; }
  /// Image position of marker k at the present state; false when it is behind the camera.
  bool marker(std::size_t k, Vec2* x);

  std::size_t patch_count() const { return patch_count_; }
  /// Where patch k was seen in the last frame; false when it was not, or was rejected.
  bool patch(std::size_t k, Vec2* x) const;

 private:
  struct Slot {
    std::uint16_t id;     // of its surface point
    Mat2 reference;       // dx/d(u,v) where the patch was captured
    Vec2 seen, expected;  // last frame: where it was found, where it was predicted
    bool was_seen;
    std::uint8_t frames_apart;  // since it last matched the first frame's patch
  };

  Status check_frame(const FrameView& frame) const;
  Status place_markers(Span<const Vec2> markers);
  void seed_patches();
  void mark_visible_cells(int cell_px);
  bool seed(Vec2 x, float min_distance);
  Observation look(std::size_t k, const Prediction& p, int round);
  Observation follow(std::size_t k, const Prediction& p);
  void look_and_solve(int round);
  void expect_motion();
  PixelBox model_box() const;
  void keep_small(std::uint8_t* pixels) const;
  void note_seen();

  Estimator estimator_;
  Pyramid current_, previous_;
  PatchTracker patches_;
  TrackerLimits limits_;
  TrackerOptions options_;
  FrameResult result_;
  Slot* slots_ = nullptr;
  Observation* observations_ = nullptr;
  std::uint16_t* marker_ids_ = nullptr;
  Corner* corners_ = nullptr;
  // Small pictures (the pyramid's top level) of the first and of the last trusted frame, and the model's place in them.
  std::uint8_t *first_small_ = nullptr, *last_small_ = nullptr;
  PixelBox first_box_, last_box_;
  View first_view_;
  int bad_frames_ = 0;
  std::uint8_t *cells_ = nullptr, *scratch_ = nullptr;
  std::size_t scratch_bytes_ = 0, patch_count_ = 0, marker_count_ = 0;
  bool started_ = false;
};

}  // namespace pliant
