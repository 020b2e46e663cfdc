// The published dynamics q' = K q + f_g, integrated by Euler steps (Eq. 9, 12, 13), and two variants that choose their step
// length (docs/algorithms.md, section 5.1). Departures from the paper: the paper writes its objective as a sum of lengths, but
// Eq. 9 to 13 are the gradient of half the sum of squared lengths, which is minimised here. The preconditioned variants
// divide each parameter's step by its diagonal of H; otherwise the largest stable step falls with the number of points and
// pixels.
#include "pliant/euler.hpp"

namespace pliant {

namespace {

/// Tuning of the step length. All values are from `pliant bench fit` (docs/experiments.md) or round.
struct EulerTuning {
  /// Costs with the highest of which a Barzilai-Borwein step is compared, count. The usual value of the non-monotone rule.
  int memory = 10;
  /// Steps in which the lowest cost must fall by the relative decrease, count. Round value, not tuned.
  int window = 30;
  /// Step lengths tried while the cost rises, count. Each is half the one before. Round value, not tuned.
  int halvings = 12;
  /// Shortest and longest Barzilai-Borwein step, as multiples of the safe step (`safe_delta`). Round values, not tuned.
  float least_step = 0.1f, longest_step = 1e3f;
};
constexpr EulerTuning kTuning{};
constexpr int kMemory = kTuning.memory, kWindow = kTuning.window, kHalvings = kTuning.halvings;

/// Diagonal preconditioner 1 / H_kk; 0 for an unobserved unknown.
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

/// A descent: its last step, the gradient before that step, and the costs of the last steps.
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

  /// delta = s^T D s / s^T y, where s is the last step and y the decrease of the gradient g = -dE/dq by it.
  void choose_delta() {
    if (options.step != EulerStep::barzilai_borwein || taken == 0) return;
    float sds = 0, sy = 0;
    for (std::size_t k = 0; k < count(); ++k) {
      sds += last_step[k] * last_step[k] * equations.h(k, k);
      sy += last_step[k] * (last_gradient[k] - equations.g(k));
    }
    delta = sy > 0 ? clamp(sds / sy, kTuning.least_step * safe, kTuning.longest_step * safe) : safe;
  }

  void propose(float length) {
    for (std::size_t k = 0; k < count(); ++k) {
      const float scale = is_published() ? 1.0f : inverse_diagonal(equations, k);
      step[k] = equations.clamped(k, length * scale * equations.g(k));
    }
  }

  float highest_allowed() const {
    if (options.step != EulerStep::barzilai_borwein) return cost;
    float highest = cost;
    for (float c : costs) highest = max(highest, c);
    return highest;
  }

  /// Takes one step. \return false if no step length lowers the cost.
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
