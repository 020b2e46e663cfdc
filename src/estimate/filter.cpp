// Constant-velocity Kalman and One-Euro filters (docs/algorithms.md, section 7.10). The pairs (value, velocity) are
// independent: the coupling of the parameters is in the solver, which has their full normal equations.
#include "pliant/filter.hpp"

#include "base/arrays.hpp"
#include "estimate/filter_tuning.hpp"

namespace pliant {

namespace {

bool is_finite_view(const View& v) {
  return is_finite(Vec3{v.q.x, v.q.y, v.q.z}) && is_finite(v.q.w) && is_finite(v.s) && v.s > 0 &&
         is_finite(v.tau) && is_finite(v.rho) && v.rho > 0;
}

bool are_variances(const float* x, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i)
    if (!is_finite(x[i]) || x[i] < 0) return false;
  return true;
}

/// Forgets the velocity. The variance of the value stays.
void stop(MotionState& s, float acceleration) {
  const float speed = kMotionTuning.start_time * acceleration;
  s = {0, s.xx, 0, speed * speed};
}

/// x += T v, v decays; the acceleration adds the process noise Q (docs/algorithms.md, section 7.10).
void predict_state(MotionState& s, float t, float fade, float acceleration) {
  const float q = acceleration * acceleration * t * t;
  s.xx += t * (2 * s.xv + t * s.vv) + 0.25f * q * t * t;
  s.xv = fade * (s.xv + t * s.vv) + 0.5f * q * t;
  s.vv = fade * fade * s.vv + q;
  s.velocity *= fade;
}

/// Corrects one pair. \return the correction of the value: gain times innovation.
float correct_state(MotionState& s, float innovation, float variance, float acceleration) {
  constexpr float gate = kMotionTuning.gate_sd;
  const float all = s.xx + variance;
  if (!(all > 0)) return innovation;
  if (innovation * innovation >
      gate * gate * all) {  // a jump: the old velocity does not apply to the new place
    s.xx = variance;
    stop(s, acceleration);
    return innovation;
  }
  const float gain = s.xx / all, speed_gain = s.xv / all;
  s.velocity += speed_gain * innovation;
  s.vv = max(s.vv - speed_gain * s.xv, 0);
  s.xv *= 1 - gain;
  s.xx *= 1 - gain;
  return gain * innovation;
}

/// Standard deviation of the acceleration of a pose unknown.
constexpr float acceleration(int unknown) {
  return unknown < kLogScale    ? kMotionTuning.turn_acceleration
         : unknown == kLogScale ? kMotionTuning.log_scale_acceleration
                                : kMotionTuning.shift_acceleration;
}

float low_pass_gain(float cutoff_hz, float seconds) {
  constexpr float kTwoPi = 6.2831853f;
  // Far more than what a quotient still tells from 1: a speed in empty ranges is infinite.
  constexpr float kAll = 1e9f;
  const float x = kTwoPi * cutoff_hz * seconds;
  return x < kAll ? x / (1 + x) : 1.0f;
}

/// Follows the speed of what moved by `step`. \return the gain of its own low pass.
float follow_speed(Vec3 step, float per_speed, float slow, float seconds, Vec3* speed) {
  *speed = *speed + slow * ((1.0f / seconds) * step - *speed);
  return low_pass_gain(kSmoothingTuning.least_cutoff + per_speed * length(*speed), seconds);
}

}  // namespace

void MotionFilter::lay_out(Arena& arena, std::size_t parameters) {
  q_ = arena.take<float>(parameters);
  range_ = arena.take<float>(parameters);
  states_ = arena.take<MotionState>(parameters);
  capacity_ = parameters;
  count_ = 0;
}

Status MotionFilter::start(const View& view, const float* q, const float* range, std::size_t parameters) {
  if (parameters > capacity_) return Status::capacity;
  if (q == nullptr || range == nullptr || !is_finite_view(view) || !are_finite(q, parameters) ||
      !are_finite(range, parameters))
    return Status::bad_argument;
  count_ = parameters;
  copy(range, count_, range_);
  move_to(view, q);
  return Status::ok;
}

void MotionFilter::move_to(const View& view, const float* q) {
  view_ = view;
  copy(q, count_, q_);
  for (MotionState& s : pose_) s = {};
  for (std::size_t i = 0; i < count_; ++i) states_[i] = {};
  forget_velocities();
}

void MotionFilter::forget_velocities() {
  for (int k = 0; k < kPoseUnknowns; ++k) stop(pose_[k], acceleration(k));
  for (std::size_t i = 0; i < count_; ++i) stop(states_[i], kMotionTuning.parameter_acceleration * range_[i]);
}

void MotionFilter::predict(float seconds) {
  if (!(seconds > 0)) return;
  const float t = min(seconds, kMotionTuning.longest_step);
  const float fade = kMotionTuning.pose_memory / (kMotionTuning.pose_memory + t);
  float step[kPoseUnknowns];
  for (int k = 0; k < kPoseUnknowns; ++k) {
    step[k] = t * pose_[k].velocity;
    predict_state(pose_[k], t, fade, acceleration(k));
  }
  view_ = moved(view_, step, kPoseUnknowns);
  const float fade_expression = kMotionTuning.expression_memory / (kMotionTuning.expression_memory + t);
  for (std::size_t i = 0; i < count_; ++i) {
    q_[i] += t * states_[i].velocity;
    predict_state(states_[i], t, fade_expression, kMotionTuning.parameter_acceleration * range_[i]);
  }
}

Status MotionFilter::correct(const View& view, const float* q, const float* pose_variance,
                             const float* variance) {
  if (q == nullptr || pose_variance == nullptr || variance == nullptr || !is_finite_view(view) ||
      !are_finite(q, count_) || !are_variances(pose_variance, kPoseUnknowns) ||
      !are_variances(variance, count_))
    return Status::bad_argument;
  const Vec3 turn = log_rotation(view.q * conjugate(view_.q));
  const float innovation[kPoseUnknowns] = {turn.x,
                                           turn.y,
                                           turn.z,
                                           2 * (view.s - view_.s) / (view.s + view_.s),
                                           view.tau.x - view_.tau.x,
                                           view.tau.y - view_.tau.y};
  float step[kPoseUnknowns];
  for (int k = 0; k < kPoseUnknowns; ++k)
    step[k] = correct_state(pose_[k], innovation[k], pose_variance[k], acceleration(k));
  view_ = moved(view_, step, kPoseUnknowns);
  for (std::size_t i = 0; i < count_; ++i) {
    const float off = q[i] - q_[i];
    q_[i] += range_[i] > 0 ? correct_state(states_[i], off, variance[i],
                                           kMotionTuning.parameter_acceleration * range_[i])
                           : off;
  }
  return Status::ok;
}

void Smoother::lay_out(Arena& arena, std::size_t parameters) {
  q_ = arena.take<float>(parameters);
  speed_ = arena.take<float>(parameters);
  capacity_ = parameters;
  is_fresh_ = true;
}

Status Smoother::add(const Pose& pose, const float* q, const float* range, std::size_t parameters,
                     float seconds) {
  constexpr SmoothingTuning t = kSmoothingTuning;
  if (parameters > capacity_) return Status::capacity;
  if (q == nullptr || range == nullptr || !is_finite(pose) || !is_finite(seconds) ||
      !are_finite(q, parameters) || (!is_fresh_ && seconds < t.least_seconds))
    return Status::bad_argument;
  if (is_fresh_) {
    pose_ = pose;
    turn_speed_ = shift_speed_ = {};
    for (std::size_t i = 0; i < parameters; ++i) {
      q_[i] = q[i];
      speed_[i] = 0;
    }
    is_fresh_ = false;
    return Status::ok;
  }
  const float slow = low_pass_gain(t.speed_cutoff, seconds), rate = 1.0f / seconds;
  const Vec3 turn = log_rotation(pose.q * conjugate(pose_.q)), shift = pose.t - pose_.t;
  const float a = follow_speed(turn, t.turn_gain, slow, seconds, &turn_speed_);
  const float b = follow_speed(shift, t.shift_gain, slow, seconds, &shift_speed_);
  pose_ = {normalised(exp_rotation(a * turn) * pose_.q), pose_.t + b * shift};
  for (std::size_t i = 0; i < parameters; ++i) {
    if (!(range[i] > 0)) {  // held: it changes with the person, and the pose turns at once then, too
      q_[i] = q[i];
      continue;
    }
    const float off = q[i] - q_[i];
    speed_[i] += slow * (rate * off - speed_[i]);
    const float ranges = magnitude(speed_[i]) / range[i];
    q_[i] += low_pass_gain(t.least_cutoff + t.parameter_gain * ranges, seconds) * off;
  }
  return Status::ok;
}

}  // namespace pliant
