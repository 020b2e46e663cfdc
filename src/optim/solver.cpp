// Levenberg-Marquardt (docs/algorithms.md, section 5.2). Solving H x = f_g replaces the Euler steps along f_g of Eq. 13
// and needs no step size.
#include "pliant/solver.hpp"

namespace pliant {

namespace {

/// Tuning of the damping, a factor on diag(H). Round values, not tuned: the damped equations only matter after a refused
/// step.
struct SolverTuning {
  /// Damping of the first step. Small enough that the step is nearly that of Gauss-Newton.
  float initial_damping = 1e-4f;
  /// Factors on the damping after an accepted and after a refused step.
  float fall = 0.1f, rise = 10;
  /// Least damping after an accepted step, and after a refused one. The second is the first value that changes a step
  /// noticeably.
  float least = 1e-7f, least_after_refusal = 1e-3f;
};
constexpr SolverTuning kTuning{};

}  // namespace

SolverReport minimise(const LeastSquaresProblem& problem, const SolverOptions& options,
                      NormalEquations& equations, float* step) {
  SolverReport report;
  float damping = kTuning.initial_damping, cost = problem.linearise(problem.context, equations);
  report.initial_cost = cost;
  const float least_gain = options.predicted_decrease;
  int accepted = 0, refused = 0;
  while (accepted < options.max_accepted && report.iterations < options.max_steps) {
    equations.solve(damping, step);
    const float predicted = equations.predicted_decrease(step);
    if (least_gain > 0 && predicted <= least_gain * cost) {
      report.stop_reason = StopReason::converged;
      break;
    }
    ++report.iterations;
    const float trial = problem.try_step(problem.context, step);
    report.ends_with_refused_step = !(trial < cost);  // true for NaN
    if (report.ends_with_refused_step) {
      damping = max(kTuning.rise * damping, kTuning.least_after_refusal);
      if (++refused < options.max_refused) continue;
      report.stop_reason = StopReason::no_decrease;
      break;
    }
    problem.accept(problem.context);
    const float decrease = cost - trial, error = decrease - predicted;
    cost = trial;
    damping = max(kTuning.fall * damping, kTuning.least);
    ++accepted;
    refused = 0;
    // A step whose gain differs from its prediction by a fraction e leaves about e^2 of that gain to the next step.
    if (decrease <= options.measured_decrease * cost ||
        (least_gain > 0 && error * error <= least_gain * cost * predicted)) {
      report.stop_reason = StopReason::converged;
      break;
    }
    if (accepted < options.max_accepted && report.iterations < options.max_steps)
      cost = problem.linearise(problem.context, equations);
  }
  report.final_cost = cost;
  report.undetermined = equations.undetermined_count();
  return report;
}

}  // namespace pliant
