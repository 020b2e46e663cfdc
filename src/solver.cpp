// Damped Gauss-Newton on packed normal equations (ALGORITHMS 5.2-5.5). The published Euler dynamics (Eq. 12, 13) is the
// gradient descent of the same cost; solving H x = f_g instead of stepping along f_g removes its step size.
#include "pliant/solver.hpp"

namespace pliant {

namespace {
constexpr float kSmallestPivot = 1e-6f;  // of the unit-diagonal matrix
constexpr int kLimitRounds = 8;
}  // namespace

void NormalEquations::lay_out(Arena& arena, std::size_t unknowns) {
  const std::size_t packed = unknowns * (unknowns + 1) / 2;
  h_ = arena.take<float>(packed);
  factor_ = arena.take<float>(packed);
  float** const vectors[] = {&g_, &scale_, &lower_, &upper_, &right_, &solution_};
  for (float** vector : vectors) *vector = arena.take<float>(unknowns);
  pinned_ = arena.take<std::uint8_t>(unknowns);
  capacity_ = unknowns;
  count_ = 0;
}

void NormalEquations::reset(std::size_t count) {
  PLIANT_ASSERT(count <= capacity_);
  count_ = count;
  for (std::size_t i = 0; i < count * (count + 1) / 2; ++i) h_[i] = 0;
  for (std::size_t i = 0; i < count; ++i) {
    g_[i] = 0;
    lower_[i] = -1e30f;
    upper_[i] = 1e30f;
  }
}

void NormalEquations::add(const std::uint16_t* unknown, const Vec2* column, std::size_t columns,
                          Vec2 residual, Sym2 w) {
  for (std::size_t i = 0; i < columns; ++i) {
    const Vec2 b = column[i];
    const float wx = w.xx * b.x + w.xy * b.y, wy = w.xy * b.x + w.yy * b.y;
    g_[unknown[i]] += wx * residual.x + wy * residual.y;
    float* row = h_ + index(unknown[i], 0);  // h_(i, j) = row[j]; only j >= i is stored
    for (std::size_t j = i; j < columns; ++j) row[unknown[j]] += wx * column[j].x + wy * column[j].y;
  }
}

void NormalEquations::add_prior(std::size_t unknown, float residual, float weight) {
  h_[index(unknown, unknown)] += weight;
  g_[unknown] += weight * residual;
}

void NormalEquations::set_limits(std::size_t unknown, float lower, float upper) {
  lower_[unknown] = lower;
  upper_[unknown] = upper;
}

/// U^T U = S H S + damping I, pinned and undetermined unknowns replaced by identity rows. Outer-product form: the inner
/// loop runs along a packed row.
void NormalEquations::factorise(float damping) {
  const std::size_t n = count_;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i; j < n; ++j) {
      const bool pinned = pinned_[i] != 0 || pinned_[j] != 0;
      factor_[index(i, j)] = i == j ? (pinned ? 1.0f : h_[index(i, j)] * scale_[i] * scale_[i] + damping)
                                    : (pinned ? 0.0f : h_[index(i, j)] * scale_[i] * scale_[j]);
    }
  for (std::size_t k = 0; k < n; ++k) {
    float* row = factor_ + index(k, k) - k;
    if (row[k] < kSmallestPivot) {  // not seen by any observation, given the unknowns before it
      pinned_[k] = 2;
      row[k] = 1;
      for (std::size_t j = k + 1; j < n; ++j) row[j] = 0;
      continue;
    }
    const float pivot = square_root(row[k]), inverse = 1.0f / pivot;
    row[k] = pivot;
    for (std::size_t j = k + 1; j < n; ++j) row[j] *= inverse;
    for (std::size_t i = k + 1; i < n; ++i) {
      const float f = row[i];
      if (f == 0) continue;
      float* target = factor_ + index(i, i) - i;
      for (std::size_t j = i; j < n; ++j) target[j] -= f * row[j];
    }
  }
}

/// x = (U^T U)^-1 right; `right` is used up. Undetermined unknowns come out zero.
void NormalEquations::back_substitute(const float* right, float* x) {
  const std::size_t n = count_;
  for (std::size_t i = 0; i < n; ++i) x[i] = right[i];
  for (std::size_t k = 0; k < n; ++k) {
    const float* row = factor_ + index(k, k) - k;
    x[k] = pinned_[k] == 2 ? 0.0f : x[k] / row[k];
    for (std::size_t j = k + 1; j < n; ++j) x[j] -= row[j] * x[k];
  }
  for (std::size_t k = n; k-- > 0;) {
    const float* row = factor_ + index(k, k) - k;
    float sum = x[k];
    for (std::size_t j = k + 1; j < n; ++j) sum -= row[j] * x[j];
    x[k] = pinned_[k] == 2 ? 0.0f : sum / row[k];
  }
}

void NormalEquations::solve(float damping, float* step) {
  const std::size_t n = count_;
  for (std::size_t i = 0; i < n; ++i) {
    const float d = h_[index(i, i)];
    scale_[i] = d > 0 ? 1.0f / square_root(d) : 1.0f;
    pinned_[i] = d > 0 ? 0 : 2;
    step[i] = 0;
  }
  for (int round = 0; round < kLimitRounds; ++round) {
    for (std::size_t i = 0; i < n; ++i) right_[i] = g_[i];
    for (std::size_t k = 0; k < n; ++k)  // what is pinned to a limit moves to the right-hand side
      if (pinned_[k] == 1)
        for (std::size_t i = 0; i < n; ++i) right_[i] -= h(i, k) * step[k];
    for (std::size_t i = 0; i < n; ++i) right_[i] = pinned_[i] != 0 ? 0.0f : right_[i] * scale_[i];
    factorise(damping);
    back_substitute(right_, solution_);
    bool changed = false;
    for (std::size_t i = 0; i < n; ++i) {
      if (pinned_[i] == 1) continue;
      step[i] = pinned_[i] == 2 ? 0.0f : solution_[i] * scale_[i];
      if (step[i] < lower_[i] || step[i] > upper_[i]) {
        step[i] = clamp(step[i], lower_[i], upper_[i]);
        pinned_[i] = 1;
        changed = true;
      }
    }
    if (!changed) break;
  }
  undetermined_ = 0;
  for (std::size_t i = 0; i < n; ++i) undetermined_ += pinned_[i] == 2;
}

void NormalEquations::variances(float* variance) {
  const std::size_t n = count_;
  for (std::size_t i = 0; i < n; ++i) {
    const float d = h_[index(i, i)];
    scale_[i] = d > 0 ? 1.0f / square_root(d) : 1.0f;
    pinned_[i] = d > 0 ? 0 : 2;
  }
  factorise(0);
  undetermined_ = 0;
  for (std::size_t k = 0; k < n; ++k) {
    undetermined_ += pinned_[k] == 2;
    variance[k] = 0;
    if (pinned_[k] == 2) continue;
    // |U^-T e_k|^2, by forward substitution from k on.
    for (std::size_t j = k; j < n; ++j) solution_[j] = 0;
    solution_[k] = 1;
    float sum = 0;
    for (std::size_t i = k; i < n; ++i) {
      const float* row = factor_ + index(i, i) - i;
      const float y = pinned_[i] == 2 ? 0.0f : solution_[i] / row[i];
      sum += y * y;
      for (std::size_t j = i + 1; j < n; ++j) solution_[j] -= row[j] * y;
    }
    variance[k] = sum * scale_[k] * scale_[k];
  }
}

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
    cost = problem.linearise(problem.context, equations);
    if (decrease <= options.relative_decrease * cost) {
      report.stop_reason = StopReason::converged;
      break;
    }
  }
  report.final_cost = cost;
  report.undetermined = equations.undetermined_count();
  return report;
}

}  // namespace pliant
