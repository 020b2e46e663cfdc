// The estimator's solve: observations become image forces f_i on surface points (Eq. 9), with robust weights.
#include "estimator_problem.hpp"

namespace pliant {

namespace {

/// W (I + s^2 W)^-1: the information that is left when an error of deviation s is added. Keeps rank one.
Sym2 with_added_error(Sym2 w, float s) {
  const float s2 = s * s;
  const float a = 1 + s2 * w.xx, b = s2 * w.xy, d = 1 + s2 * w.yy;
  const float inverse = 1.0f / (a * d - b * b);
  return {inverse * (w.xx * d - w.xy * b), inverse * (w.xy * a - w.xx * b), inverse * (w.yy * a - w.xy * b)};
}

}  // namespace

std::size_t Estimator::gather(Span<Observation> observations) {
  std::size_t n = 0;
  for (std::size_t k = 0; k < observations.count; ++k) {
    Observation& o = observations[k];
    if (o.reason != Reason::found && o.reason != Reason::rejected) continue;
    const Sym2 w = o.information;
    const bool good = has_point(o.id) && is_finite(o.x) && is_finite(w.xx) && is_finite(w.xy) &&
                      is_finite(w.yy) && w.xx >= 0 && w.yy >= 0;
    o.reason = good ? Reason::found : Reason::not_visible;
    if (good && n < limits_.points) usable_[n++] = static_cast<std::uint16_t>(k);
  }
  return n;
}

SolverReport Estimator::solve(Span<Observation> observations) {
  SolverReport report;
  const std::size_t usable = started_ ? gather(observations) : 0;
  result_.tracked = static_cast<std::uint16_t>(usable);
  result_.inliers = 0;
  looked_for_ = 0;
  for (const Observation& o : observations) looked_for_ += o.reason != Reason::not_visible;
  if (usable < 4) return report;
  const float added = options_.model_error_px * static_cast<float>(width_) / 320;
  for (std::size_t k = 0; k < usable; ++k)
    information_[k] = with_added_error(observations[usable_[k]].information, added);
  EstimatorProblem problem{*this, observations, usable};
  problem.view = view_;
  constexpr Loss kStages[2] = {Loss::huber, Loss::tukey};
  for (Loss loss : kStages) {
    problem.loss = loss;
    problem.update_scale();
    const SolverReport stage = problem.minimise(options_.iterations);
    report.iterations += stage.iterations;
    report.stop_reason = stage.stop_reason;
    report.final_cost = stage.final_cost;
    report.undetermined = stage.undetermined;
    if (loss == Loss::huber) report.initial_cost = stage.initial_cost;
  }
  view_ = problem.view;
  equations_.variances(variance_);
  result_.iterations = static_cast<std::uint16_t>(result_.iterations + report.iterations);
  measure_inliers(observations, problem);
  return report;
}

void Estimator::measure_inliers(Span<Observation> observations, const EstimatorProblem& problem) {
  float sum = 0;
  std::uint16_t inliers = 0;
  for (std::size_t k = 0; k < problem.usable; ++k) {
    float px;
    const float u = problem.residual(k, &px) / problem.scale;
    if (evaluate(Loss::tukey, u).weight <= 0.1f) {
      observations[usable_[k]].reason = Reason::rejected;
      continue;
    }
    ++inliers;
    sum += px * px;
  }
  result_.inliers = inliers;
  result_.rms_px = inliers > 0 ? square_root(sum / static_cast<float>(inliers)) : 0.0f;
}

}  // namespace pliant
