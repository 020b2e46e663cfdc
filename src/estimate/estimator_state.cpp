// States that come from outside and go there.
#include "estimate/estimator_impl.hpp"

namespace pliant {

void Estimator::save(State* state) const {
  const Impl& s = *impl_;
  const float* const variance = s.solver.variance();
  state->pose = pose_of(s.state.view);
  for (int k = 0; k < kPoseUnknowns; ++k) state->pose_sd[k] = square_root(variance[k]);
  for (std::size_t i = 0; i < s.parameter_count(); ++i) {
    if (state->q != nullptr) state->q[i] = s.state.q[i];
    const std::uint16_t column = s.cascade.column_of(i);
    if (state->sd != nullptr)
      state->sd[i] = column == kNone ? 0.0f : square_root(variance[kPoseUnknowns + column]);
  }
}

Status Estimator::restore(const State& state) {
  if (!is_started()) return Status::not_started;
  Impl& s = *impl_;
  if (state.q == nullptr || !is_possible(state.pose, s.camera) || !are_finite(state.q, s.parameter_count()))
    return Status::bad_argument;
  s.set_view(state.pose);
  s.predictions = {};
  s.motion.expect(s.state.view);
  for (std::size_t k = 0; k < s.cascade.column_count(); ++k) {
    const std::uint16_t i = s.cascade.parameter_of(k);
    const Parameter& p = model().parameters()[i];
    s.state.q[i] = clamp(state.q[i], p.minimum, p.maximum);
    s.motion.expect(i, s.state.q[i]);
  }
  s.update_surface(1);
  if (s.place_silhouette != nullptr) s.place_silhouette(s);
  return Status::ok;
}

Status Estimator::accept(const State& measured, FrameResult* result) {
  const Status status = restore(measured);
  if (status != Status::ok) return status;
  Impl& s = *impl_;
  copy(s.state, s.parameter_count(), &s.trusted);
  s.motion.move(s.state);
  result->state = s.monitor.add(true);
  result->pose = pose_of(s.state.view);
  result->smoothed_pose = s.motion.smoothed_pose();
  return status;
}

}  // namespace pliant
