// Damped Gauss-Newton (ALGORITHMS 5.2). The published Euler dynamics (Eq. 12, 13) is the gradient descent of the same cost;
// solving H x = f_g instead of stepping along f_g removes its step size.
#include "pliant/solver.hpp"

namespace pliant {

SolverReport minimise(const LeastSquaresProblem& problem, const SolverOptions& options,
                      NormalEquations& equations, float* step) {
  SolverReport report;
  float damping = options.initial_damping;
  float cost = problem.linearise(problem.context, equations);
  report.initial_cost = cost;
  for (report.iterations = 0; report.iterations < options.max_iterations;) {
    ++report.iterations;
    float trial = cost;
    bool accepted = false;
    for (int k = 0; k < options.max_tries && !accepted; ++k) {
      equations.solve(damping, step);
      trial = problem.try_step(problem.context, step);
      accepted = trial < cost;  // false for NaN
      damping = accepted ? max(0.1f * damping, 1e-7f) : max(10 * damping, 1e-3f);
    }
    if (!accepted) {
      report.stop_reason = StopReason::no_decrease;
      break;
    }
    problem.accept(problem.context);
    const float decrease = cost - trial;
    cost = trial;
    const bool converged = decrease <= options.relative_decrease * cost;
    const bool is_last = converged || report.iterations == options.max_iterations;
    if (!is_last || options.leave_equations) cost = problem.linearise(problem.context, equations);
    if (converged) {
      report.stop_reason = StopReason::converged;
      break;
    }
  }
  report.final_cost = cost;
  report.undetermined = equations.undetermined_count();
  return report;
}

}  // namespace pliant
