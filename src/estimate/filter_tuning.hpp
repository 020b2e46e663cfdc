#pragma once
// Tuning of prediction and smoothing over time.

namespace pliant {

/// Tuning of the motion filter. The accelerations are standard deviations of white noise that drives the velocities. They
/// are the largest accelerations of a head and a face, estimated by hand and not optimised. On the Talking Face video the
/// prediction of this filter made no measurable difference in addition to the measured coarse translation. Only its
/// covariance matters.
struct MotionTuning {
  /// rad / s^2. A head that starts to turn.
  float turn_acceleration = 40;
  /// 1 / s^2. A head that starts to approach.
  float log_scale_acceleration = 15;
  /// mm / s^2. A head that starts to move sideways.
  float shift_acceleration = 5000;
  /// Parameter ranges / s^2. A mouth that starts to open.
  float parameter_acceleration = 60;
  /// s. Without measurements the velocity of the pose halves in this time. Round value, not tuned.
  float pose_memory = 0.5f;
  /// s. The same of expressions, which stop as fast as they start. Round value, not tuned.
  float expression_memory = 0.1f;
  /// Standard deviations. A larger innovation is a jump and resets the velocity. The usual
  /// five deviations, not tuned.
  float gate_sd = 5;
  /// s. Longest time step, so that variances stay finite. Round value, not tuned.
  float longest_step = 1;
  /// s. Standard deviation of the velocity at rest, as the time for which the acceleration may have acted. Round value.
  float start_time = 0.3f;
};
inline constexpr MotionTuning kMotionTuning{};

/// Tuning of the One-Euro filter. Cut-off frequency = least + gain x speed. Round
/// values for a still picture at rest and a lag below an eighth of a second; tests/unit/estimate/filter_test.cpp holds both.
struct SmoothingTuning {
  /// Hz, at rest.
  float least_cutoff = 1.5f;
  /// Hz per rad / s of turning.
  float turn_gain = 4;
  /// Hz per mm / s of translation.
  float shift_gain = 0.02f;
  /// Hz per parameter range / s.
  float parameter_gain = 3;
  /// Hz. Cut-off frequency of the speeds themselves. The default of the paper.
  float speed_cutoff = 1;
  /// s. Shortest time between two samples, so that speeds stay finite. Round value.
  float least_seconds = 1e-6f;
};
inline constexpr SmoothingTuning kSmoothingTuning{};

}  // namespace pliant
