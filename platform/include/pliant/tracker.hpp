#pragma once
/// \file tracker.hpp
/// The composition: frames + vision + core -> pose, expression and surface points, frame by frame.
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/estimator.hpp"
#include "pliant/frame.hpp"
#include "pliant/model.hpp"

namespace pliant {

/// Capacities; they fix the arena's size. The defaults suit 320 x 240.
struct TrackerLimits {
  std::uint16_t width = 320, height = 240;  ///< of the frames, px
  std::uint16_t patches = 96;               ///< tracked surface patches
  std::uint16_t markers = 0;                ///< followed but never observed
  std::uint16_t vertices = 512;
  std::uint8_t pyramid_levels = 3;
  std::uint8_t patch_window = 11;           ///< px, odd
};

struct TrackerOptions {
  EstimatorOptions estimator;
  float marker_exclusion_px = 8;    ///< no patch is centred within this distance of a marker in the first frame
  float min_correlation = 0.7f;     ///< with the patch of the first frame
  float forward_backward_px = 1.0f;
};

/// Follows one model through a stream of frames of one size. All memory is taken at creation.
class Tracker {
 public:
  void lay_out(Arena& arena, const Model& model, const TrackerLimits& limits);

  /// Starts on `frame` (frame 0) from a known state; patches are captured in it. Markers are image points (px) of this
  /// frame, at most limits.markers of them, cast onto the posed mesh; one that misses takes the nearest surface point.
  /// \return bad_argument, size_mismatch, capacity, too_few_points (no texture to hold on to).
  Status start(const FrameView& frame, const Camera& camera, const Pose& pose, const float* q, Span<const Vec2> markers,
               const TrackerOptions& options);

  /// The next frame. \return not_started, bad_argument, size_mismatch; the state is then as before.
  Status update(const FrameView& frame, FrameResult* result);

  /// What `update` would return for the frame of `start`: state tracking, the pose given.
  const FrameResult& result() const { return result_; }
  Estimator& estimator() { return estimator_; }
  /// Image position of marker k at the present state; false when it is behind the camera.
  bool marker(std::size_t k, Vec2* x);

 private:
  Estimator estimator_;
  FrameResult result_;
};

}  // namespace pliant
