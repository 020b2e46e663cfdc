// States that come from outside and go there.
#include "estimate/estimator_impl.hpp"
#include "model/parameters.hpp"

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

Status Estimator::Impl::expect(const State& saved) {
  if (saved.q == nullptr || !is_possible(saved.pose, camera) || !are_finite(saved.q, parameter_count()))
    return Status::bad_argument;
  set_view(saved.pose);
  predictions = {};
  motion.expect(state.view);
  for (std::size_t k = 0; k < cascade.column_count(); ++k) {
    const std::uint16_t i = cascade.parameter_of(k);
    state.q[i] = within_range(cascade.model().parameters()[i], saved.q[i]);
    motion.expect(i, state.q[i]);
  }
  return Status::ok;
}

Status Estimator::restore(const State& saved) {
  if (!is_started()) return Status::not_started;
  Impl& s = *impl_;
  const Status status = s.expect(saved);
  if (status != Status::ok) return status;
  s.update_surface(1);
  if (s.place_silhouette != nullptr) s.place_silhouette(s);
  return status;
}

Status Estimator::accept(const State& measured, FrameResult* result) {
  if (!is_started()) return Status::not_started;
  Impl& s = *impl_;
  const Status status = s.expect(measured);
  if (status != Status::ok) return status;
  copy(s.state, s.parameter_count(), &s.trusted);
  s.surface_is_trusted = false;
  s.restore_surface();
  if (s.place_silhouette != nullptr) s.place_silhouette(s);
  s.motion.move(s.state);
  result->state = s.monitor.add(true);
  result->pose = pose_of(s.state.view);
  result->smoothed_pose = s.motion.smoothed_pose();
  return status;
}

}  // namespace pliant
