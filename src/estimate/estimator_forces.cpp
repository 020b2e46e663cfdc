// Rejection by image forces in the estimator's solve (the paper, Appendix A; ALGORITHMS 6.5). A file of its own, reached
// through a table of functions that limits name, so that a program without such limits is linked without all this.
#include "estimate/estimator_problem.hpp"

namespace pliant {

void EstimatorProblem::reject_forces() {
  const Projector projector(view, true);
  std::size_t planes = 0;
  for (std::size_t k = 0; k < e.row_count_; ++k) planes += !e.rows_[k].is_line;
  const std::size_t most = e.sample_capacity_;
  if (planes == 0) return;
  const std::size_t stride = (planes + most - 1) / most;
  float jacobian[2 * kPoseUnknowns];
  const auto rigid = [&](std::size_t row, float* b) {
    Vec2 x;
    Projector::Derivatives d{};
    if (!projector.project(e.cascade_.evaluate(e.samples_of_point(e.rows_[row].id), e.q_), &x, &d)) return false;
    for (int k = 0; k < kPoseUnknowns; ++k) {
      b[k] = d.pose[k].x;
      b[kPoseUnknowns + k] = d.pose[k].y;
    }
    return true;
  };
  std::size_t sampled = 0, seen = 0;
  for (std::size_t k = 0; k < e.row_count_; ++k)
    if (!e.rows_[k].is_line && seen++ % stride == 0 && rigid(k, e.sample_ + sampled * 2 * kPoseUnknowns))
      e.sample_force_[sampled++] = e.residuals_[k];
  ForceOptions options;
  options.noise_px = 0.1f;
  if (e.rejector_.reject(e.sample_, e.sample_force_, sampled, kPoseUnknowns, options, e.sample_keep_) !=
      Status::ok)
    return;
  for (std::size_t k = 0; k < e.row_count_; ++k)
    if (!e.rows_[k].is_line)
      e.rows_[k].is_kept = rigid(k, jacobian) && e.rejector_.agrees(jacobian, e.residuals_[k]);
}

namespace {

void lay_out(Arena& arena, ForceRejector& rejector, std::size_t sample) {
  rejector.lay_out(arena, {sample, kPoseUnknowns});
}
void reject(EstimatorProblem& problem) {
  problem.reject_forces();
}

}  // namespace

const ForceRejection kForceRejection{lay_out, reject};

}  // namespace pliant
