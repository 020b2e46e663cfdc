#include "estimate/motion_model.hpp"

#include "model/parameters.hpp"

namespace pliant {

void MotionModel::lay_out(Arena& arena, std::size_t parameters) {
  filter_.lay_out(arena, parameters);
  smoother_.lay_out(arena, parameters);
  expected_.mean.lay_out(arena, parameters);
  expected_.parameter_sd = arena.take<float>(parameters);
  scratch_ = arena.take<float>(parameters);
  count_ = parameters;
}

Status MotionModel::start(const Cascade& cascade, const ModelState& state, const EstimatorOptions& options) {
  PLIANT_ASSERT(cascade.parameter_count() == count_);
  for (std::size_t i = 0; i < count_; ++i) {
    const Parameter& p = cascade.model().parameters()[i];
    scratch_[i] = cascade.column_of(i) == kNone ? 0.0f : p.maximum - p.minimum;
  }
  const Status status = filter_.start(state.view, state.q, scratch_, count_);
  if (status != Status::ok) return status;
  copy(state, count_, &expected_.mean);
  predicts_motion_ = options.predicts_motion;
  smooths_ = options.smooths;
  smoother_.restart();
  smooth(state);
  time_ns_ = options.time_ns;
  seconds_ = kMotionModelTuning.nominal_step;
  since_sample_ = 0;
  expect_parameter_sd(cascade);
  expect_pose_variance(0);
  return Status::ok;
}

bool MotionModel::predict(std::int64_t time_ns, int bad_frames, const Cascade& cascade, ModelState* state) {
  const MotionModelTuning& t = kMotionModelTuning;
  // Times come from outside: their difference may wrap.
  const auto elapsed =
      static_cast<std::int64_t>(static_cast<std::uint64_t>(time_ns) - static_cast<std::uint64_t>(time_ns_));
  const bool repeats = elapsed >= 0 && elapsed < t.least_step_ns;
  const bool follows = !repeats && elapsed > 0 && elapsed < t.jump_ns;  // never after kNoTime
  seconds_ = follows ? static_cast<float>(elapsed) * 1e-9f : t.nominal_step;
  if (!repeats) since_sample_ += seconds_;
  if (!repeats) time_ns_ = time_ns;  // else steps of less than that add up
  if (!follows && !repeats) filter_.forget_velocities();
  filter_.predict(repeats ? 0.0f : seconds_);
  const bool is_known = bad_frames == 0 && follows, moves = predicts_motion_ && is_known;
  if (moves) state->view = filter_.view();
  expected_.mean.view = state->view;
  for (std::size_t i = 0; i < count_; ++i) {
    float mean = state->q[i];
    if (is_known && filter_.ranges()[i] > 0)
      mean = within_range(cascade.model().parameters()[i], filter_.parameters()[i]);
    expected_.mean.q[i] = mean;
    if (moves) state->q[i] = mean;
  }
  expect_parameter_sd(cascade);
  expect_pose_variance(bad_frames);
  return moves;
}

/// What each parameter may change by since the last frame. Never 0: a range may be empty.
void MotionModel::expect_parameter_sd(const Cascade& cascade) {
  const MotionModelTuning& t = kMotionModelTuning;
  for (std::size_t i = 0; i < count_; ++i) {
    const Parameter& p = cascade.model().parameters()[i];
    expected_.parameter_sd[i] =
        max(t.parameter_rate * (p.maximum - p.minimum) * min(seconds_, t.longest_parameter_time),
            t.least_parameter_sd);
  }
}

/// Sets the expected variance: that of the filter, clamped to the tuning's range, and larger after every bad frame. If the
/// filter's velocity is not used for the prediction, the motion that it predicts is added as uncertainty.
void MotionModel::expect_pose_variance(int bad_frames) {
  const MotionModelTuning& t = kMotionModelTuning;
  const auto frames = static_cast<float>(1 + bad_frames);
  for (int k = 0; k < kPoseUnknowns; ++k) {
    const MotionState& s = filter_.pose(k);
    const float motion = predicts_motion_ ? 0.0f : seconds_ * s.velocity;
    expected_.pose_variance[k] =
        frames * frames *
        clamp(s.xx + motion * motion, t.least_sd[k] * t.least_sd[k], t.most_sd[k] * t.most_sd[k]);
  }
}

void MotionModel::correct(const Cascade& cascade, const ModelState& state, const float* variance,
                          const ModelState& trusted) {
  for (std::size_t i = 0; i < count_; ++i) {
    const std::uint16_t column = cascade.column_of(i);
    scratch_[i] = column == kNone ? 0.0f : variance[kPoseUnknowns + column];
  }
  if (filter_.correct(state.view, state.q, variance, scratch_) != Status::ok)
    filter_.move_to(trusted.view, trusted.q);
  smooth(state);
  since_sample_ = 0;
}

/// Adds a sample to the smoothed output, if there is one. Where the clock stands still the sample counts as one of the usual rate.
void MotionModel::smooth(const ModelState& state) {
  const float seconds = since_sample_ > 0 ? since_sample_ : kMotionModelTuning.nominal_step;
  if (smooths_) (void)smoother_.add(pose_of(state.view), state.q, filter_.ranges(), count_, seconds);
}

void MotionModel::move(const ModelState& state) {
  filter_.move_to(state.view, state.q);
  smooth(state);
  since_sample_ = 0;
}

void MotionModel::turn(const ModelState& state, Quat by) {
  filter_.move_to(state.view, state.q);
  smoother_.turn(by);
}

void MotionModel::rest(const ModelState& state) {
  filter_.move_to(state.view, state.q);
  smoother_.restart();
}

}  // namespace pliant
