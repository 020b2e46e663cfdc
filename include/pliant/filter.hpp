#pragma once
/// \file filter.hpp
/// Prediction and smoothing over time: a constant-velocity Kalman filter over pose and parameters, and a
/// One-Euro filter for display (docs/algorithms.md, section 7.10).
#include <cstddef>

#include "pliant/arena.hpp"
#include "pliant/camera.hpp"
#include "pliant/geometry.hpp"
#include "pliant/status.hpp"

namespace pliant {

/// What the filter keeps of one unknown besides its value.
struct MotionState {
  /// Velocity of the unknown (its unit per s), and the covariance of value and velocity: xx, xv, vv.
  float velocity = 0, xx = 0, xv = 0, vv = 0;
};

/// Constant-velocity Kalman filter of a view and parameters.
///
/// Each unknown is a pair (value, velocity) that is independent of the others. The error of the rotation is a
/// small turn applied on the left, in camera axes. Velocities decay, so that a value that is not measured
/// comes to rest.
/// Bytes: 24 a parameter.
class MotionFilter {
 public:
  /// Takes its memory from the arena; called by create_in and measured_bytes (arena.hpp).
  void lay_out(Arena& arena, std::size_t parameters);

  /// Starts at rest.
  /// \param range  maximum - minimum of each parameter; a parameter with range 0 is not filtered.
  /// \return bad_argument for null or anything not finite; capacity.
  Status start(const View& view, const float* q, const float* range, std::size_t parameters);
  /// Moves the state on by `seconds`. More than 1 s counts as 1 s; 0, negative values and NaN change nothing.
  void predict(float seconds);
  /// Corrects the state by a measurement.
  /// \param pose_variance  of the pose unknowns, in PoseUnknown's order and squared units (rad, log, mm).
  /// \param variance       of each parameter, squared units of it.
  /// \return bad_argument for null, anything not finite, or a negative variance; then nothing has changed.
  Status correct(const View& view, const float* q, const float* pose_variance, const float* variance);
  /// Sets all velocities to zero and their variance to that at rest; values keep theirs.
  void forget_velocities();
  /// Continues from another state, at rest.
  void move_to(const View& view, const float* q);

  const View& view() const { return view_; }      ///< The filtered view.
  const float* parameters() const { return q_; }  ///< The filtered parameters.
  /// Range of each parameter, as given to `start`.
  const float* ranges() const { return range_; }
  const MotionState& pose(int unknown) const { return pose_[unknown]; }     ///< Filter of a pose unknown.
  const MotionState& parameter(std::size_t i) const { return states_[i]; }  ///< Filter of a parameter.

 private:
  View view_;
  MotionState pose_[kPoseUnknowns];
  float *q_ = nullptr, *range_ = nullptr;
  MotionState* states_ = nullptr;
  std::size_t count_ = 0, capacity_ = 0;
};

/// One-Euro filter of a pose and parameters (Casiez, Roussel, Vogel, CHI 2012): a low pass whose cut-off
/// frequency rises with speed, so that a resting face does not tremble and a moving one does not lag. For
/// display only: the result must not be fed back into the tracker. Bytes: 8 a parameter.
class Smoother {
 public:
  /// Takes its memory from the arena; called by create_in and measured_bytes (arena.hpp).
  void lay_out(Arena& arena, std::size_t parameters);
  /// The next sample is taken unchanged.
  void restart() { is_fresh_ = true; }
  /// The model has been turned by this rotation, in the axes of Pose::q: so is the smoothed pose.
  void turn(Quat by) { pose_.q = normalised(pose_.q * by); }
  /// Adds a sample, `seconds` after the one before.
  /// \param range  of each parameter; greater than 0 where its speed counts.
  /// \return bad_argument for null, anything but a range that is not finite, or less than 1 us after the first sample; capacity.
  ///         Then nothing has changed.
  Status add(const Pose& pose, const float* q, const float* range, std::size_t parameters, float seconds);
  const Pose& pose() const { return pose_; }      ///< The smoothed pose.
  const float* parameters() const { return q_; }  ///< The smoothed parameters.

 private:
  Pose pose_;
  Vec3 turn_speed_, shift_speed_;
  float *q_ = nullptr, *speed_ = nullptr;
  std::size_t capacity_ = 0;
  bool is_fresh_ = true;
};

}  // namespace pliant
