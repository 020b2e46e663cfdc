#pragma once
/// \file filter.hpp
/// Prediction and smoothing over time: a constant-velocity Kalman filter over pose and parameters, and the One-Euro filter
/// for what is shown (ALGORITHMS: section 7.10).
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/camera.hpp"
#include "pliant/geometry.hpp"
#include "pliant/status.hpp"

namespace pliant {

/// Deviations of the white accelerations that drive the velocities, a second squared.
struct MotionOptions {
  float turn_rad = 40;               ///< a head that starts to turn
  float log_scale = 15;              ///< or to come nearer
  float shift_mm = 5000;             ///< or to move across
  float ranges = 60;                 ///< expressions, in ranges of their parameters
  float pose_memory_s = 0.5f;        ///< a velocity that nothing confirms halves in so long
  float expression_memory_s = 0.1f;  ///< the same of expressions, which stop as fast as they start
  float gate_sd = 5;  ///< an innovation beyond so many deviations forgets the velocity: it was a jump
};

/// One value and its velocity; covariance of both.
struct MotionState {
  float velocity = 0, xx = 0, xv = 0, vv = 0;
};

/// Constant-velocity Kalman filter of a view and parameters, a pair (value, velocity) each. The rotation's error is a small
/// turn on the left, in camera axes. Velocities fade, so that what is not seen for long comes to rest.
/// Bytes: 20 a parameter.
class MotionFilter {
 public:
  void lay_out(Arena& arena, std::size_t parameters);

  /// Starts at rest. `range` is that of each parameter (maximum - minimum); one of 0 is not filtered.
  /// \return bad_argument for null or anything not finite, capacity.
  Status start(const View& view, const float* q, const float* range, std::size_t parameters,
               const MotionOptions& options);
  /// Moves the state on by `seconds` (0 or more; more than 1 s counts as 1 s). 0 changes nothing.
  void predict(float seconds);
  /// Takes what was measured, with the variances of the pose's unknowns and of the parameters.
  /// \return bad_argument for anything not finite or a negative variance: nothing has changed.
  Status correct(const View& view, const float* q, const float* pose_variance, const float* variance);
  /// At rest where it is: after a cut, or when time has jumped.
  void forget_velocities();
  /// Continues from another state, at rest.
  void move_to(const View& view, const float* q);

  const View& view() const { return view_; }
  const float* parameters() const { return q_; }
  const MotionState& pose(int unknown) const { return pose_[unknown]; }
  const MotionState& parameter(std::size_t i) const { return states_[i]; }

 private:
  float acceleration(int unknown) const;

  MotionOptions options_;
  View view_;
  MotionState pose_[kPoseUnknowns];
  float *q_ = nullptr, *range_ = nullptr;
  MotionState* states_ = nullptr;
  std::size_t count_ = 0, capacity_ = 0;
};

/// One-Euro filter (Casiez, Roussel, Vogel 2012): a low pass whose cut-off rises with speed, so that what rests does not
/// tremble and what moves does not lag. For output only: never fed back.
struct OneEuroOptions {
  float min_cutoff_hz = 1.5f;        ///< at rest
  float turn_hz_per_rad_s = 4;       ///< how the cut-off rises with the speed of turning,
  float shift_hz_per_mm_s = 0.02f;   ///< of moving,
  float parameter_hz_per_range = 3;  ///< and of an expression, in ranges a second
  float speed_cutoff_hz = 1;
};

/// Smooths a pose and parameters. Bytes: 8 a parameter.
class Smoother {
 public:
  void lay_out(Arena& arena, std::size_t parameters);
  /// The next sample is taken as it is.
  void restart() { is_fresh_ = true; }
  /// \param range  of each parameter, > 0 where it is smoothed.
  /// \return bad_argument for anything not finite or no time passed (the result stays), capacity.
  Status add(const Pose& pose, const float* q, const float* range, std::size_t parameters, float seconds,
             const OneEuroOptions& options);
  const Pose& pose() const { return pose_; }
  const float* parameters() const { return q_; }

 private:
  Pose pose_;
  Vec3 turn_speed_, shift_speed_;
  float *q_ = nullptr, *speed_ = nullptr;
  std::size_t capacity_ = 0;
  bool is_fresh_ = true;
};

}  // namespace pliant
