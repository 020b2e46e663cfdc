#include "estimate/force_rejection.hpp"

namespace pliant {

void RowForces::lay_out(Arena& arena, std::size_t sample) {
  if (sample > kMcdMaxRows) sample = kMcdMaxRows;
  sample_capacity_ = sample;
  jacobian_ = arena.take<float>(2 * kPoseUnknowns * sample);
  force_ = arena.take<Vec2>(sample);
  keep_ = arena.take<std::uint8_t>(sample);
  rejector_.lay_out(arena, {sample, kPoseUnknowns});
}

void RowForces::reject(FrameProblem& problem) {
  ObservationRows& rows = problem.rows;
  const Projector projector(problem.state.view, true);
  std::size_t planes = 0;
  for (std::size_t k = 0; k < rows.count(); ++k) planes += !rows[k].is_line;
  if (planes == 0) return;
  const std::size_t stride = (planes + sample_capacity_ - 1) / sample_capacity_;
  std::size_t sampled = 0, seen = 0;
  for (std::size_t k = 0; k < rows.count(); ++k)
    if (!rows[k].is_line && seen++ % stride == 0 &&
        problem.pose_jacobian(k, projector, jacobian_ + sampled * 2 * kPoseUnknowns))
      force_[sampled++] = rows.residual(k);
  if (rejector_.reject(jacobian_, force_, sampled, kPoseUnknowns, {}, keep_) != Status::ok) return;
  for (std::size_t k = 0; k < rows.count(); ++k) {
    float jacobian[2 * kPoseUnknowns];
    if (!rows[k].is_line)
      rows[k].is_kept =
          problem.pose_jacobian(k, projector, jacobian) && rejector_.agrees(jacobian, rows.residual(k));
  }
}

namespace {

RowForces* lay_out(Arena& arena, std::size_t sample) {
  return create_part<RowForces>(arena, sample);
}

void reject(RowForces& forces, FrameProblem& problem) {
  forces.reject(problem);
}

}  // namespace

const ForceRejection kForceRejection{lay_out, reject};

}  // namespace pliant
