// The published dynamics, q' = K q + f_g integrated by Euler steps (Eq. 9, 12, 13), and forms of it that need no step size to be
// found by hand. Departures from the paper: its objective is written as a sum of lengths, but Eq. 9-13 are the gradient of half
// the sum of their squares, which is what is descended here; and the preconditioned forms scale each parameter by its own
// diagonal of H, without which the step that is stable goes down with every point and pixel added.
#include "pliant/euler.hpp"

namespace pliant {

namespace {

constexpr int kMemory =
    10;  // costs that a Barzilai-Borwein step is measured against, and of the stopping rule
constexpr int kWindow = 30;  // steps in which the lowest cost must go down
constexpr int kHalvings = 12;
constexpr float kLongestShare = 1e3f;  // of the safe step

/// Diagonal preconditioner 1 / H_kk; 0 for an unknown that nothing observes.
float inverse_diagonal(NormalEquations& equations, std::size_t k) {
  const float d = equations.h(k, k);
  return d > 0 ? 1.0f / d : 0.0f;
}

/// 1 / the largest absolute row sum of D^-1/2 H D^-1/2.
float safe_delta(NormalEquations& equations) {
  float largest = 1;
  for (std::size_t i = 0; i < equations.count(); ++i) {
    const float di = inverse_diagonal(equations, i);
    float row = 0;
    for (std::size_t j = 0; j < equations.count(); ++j)
      row += magnitude(equations.h(i, j)) * square_root(di * inverse_diagonal(equations, j));
    largest = max(largest, row);
  }
  return 1.0f / largest;
}

/// The descent in progress: the step last taken, the gradient before it, and the costs of the last steps.
struct Descent {
  const LeastSquaresProblem& problem;
  const EulerOptions& options;
  NormalEquations& equations;
  float *step, *last_step, *last_gradient;
  float cost = 0, delta = 0, safe = 0;
  float costs[kMemory] = {};
  int taken = 0;

  std::size_t count() const { return equations.count(); }
  bool is_published() const { return options.step == EulerStep::published; }

  void start() {
    equations.keep_gradient_only(is_published());
    cost = problem.linearise(problem.context, equations);
    safe = delta = is_published() ? options.delta : safe_delta(equations);
    equations.keep_gradient_only(true);
    for (float& c : costs) c = cost;
  }

  /// delta = s^T D s / s^T y, with s the last step and y what it took off the gradient g = -dE/dq.
  void choose_delta() {
    if (options.step != EulerStep::barzilai_borwein || taken == 0) return;
    float sds = 0, sy = 0;
    for (std::size_t k = 0; k < count(); ++k) {
      sds += last_step[k] * last_step[k] * equations.h(k, k);
      sy += last_step[k] * (last_gradient[k] - equations.g(k));
    }
    delta = sy > 0 ? clamp(sds / sy, 0.1f * safe, kLongestShare * safe) : safe;
  }

  void propose(float share) {
    for (std::size_t k = 0; k < count(); ++k) {
      const float scale = is_published() ? 1.0f : inverse_diagonal(equations, k);
      step[k] = equations.clamped(k, share * scale * equations.g(k));
    }
  }

  float highest_allowed() const {
    if (options.step != EulerStep::barzilai_borwein) return cost;
    float highest = cost;
    for (float c : costs) highest = max(highest, c);
    return highest;
  }

  /// Takes one step. \return false where no length lowers the cost.
  bool advance() {
    choose_delta();
    float trial = 0;
    bool accepted = false;
    for (int k = 0; k < kHalvings && !accepted; ++k) {
      propose(delta);
      trial = problem.try_step(problem.context, step);
      accepted = is_published() ? trial < 1e30f : trial <= highest_allowed();  // false for NaN
      if (is_published()) break;
      if (!accepted) delta *= 0.5f;
    }
    if (!accepted) return false;
    for (std::size_t k = 0; k < count(); ++k) {
      last_step[k] = step[k];
      last_gradient[k] = equations.g(k);
    }
    problem.accept(problem.context);
    cost = problem.linearise(problem.context, equations);
    costs[taken % kMemory] = cost;
    ++taken;
    return true;
  }
};

}  // namespace

SolverReport integrate(const LeastSquaresProblem& problem, const EulerOptions& options,
                       NormalEquations& equations, float* scratch) {
  const std::size_t n = equations.capacity();
  Descent descent{problem, options, equations, scratch, scratch + n, scratch + 2 * n};
  descent.start();
  SolverReport report;
  report.initial_cost = descent.cost;
  float lowest = descent.cost, before = lowest;
  for (; report.iterations < options.steps; ++report.iterations) {
    if (!descent.advance()) {
      report.stop_reason = descent.is_published() ? StopReason::diverged : StopReason::no_decrease;
      break;
    }
    lowest = min(lowest, descent.cost);
    if ((report.iterations + 1) % kWindow != 0) continue;
    if (options.relative_decrease > 0 && before - lowest <= options.relative_decrease * lowest) {
      ++report.iterations;
      report.stop_reason = StopReason::converged;
      break;
    }
    before = lowest;
  }
  report.final_cost = descent.cost;
  equations.keep_gradient_only(false);
  return report;
}

}  // namespace pliant
