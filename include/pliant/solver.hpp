#pragma once
/// \file solver.hpp
/// Damped Gauss-Newton on packed normal equations with priors and limits (ALGORITHMS: section 5.2-5.5).
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/geometry.hpp"

namespace pliant {

/// H x = g for up to `unknowns` unknowns, as accumulated from observations in a fixed order: H = sum B_i^T W_i B_i and
/// g = sum B_i^T W_i f_i (the generalised force f_g of Eq. 9). Upper triangle, packed by rows.
/// Bytes: 2 x 4 x n(n+1)/2 and 7 floats an unknown.
class NormalEquations {
 public:
  void lay_out(Arena& arena, std::size_t unknowns);
  std::size_t capacity() const { return capacity_; }
  std::size_t count() const { return count_; }

  /// Starts over with `count` unknowns, at most capacity(). No limits.
  void reset(std::size_t count);

  /// Adds one image observation: residual f = observed - projected (px), information W (1/px^2, may be of rank one),
  /// and the 2 x n derivative of the projection by its non-zero columns: unknown numbers ascending.
  /// Cost: k(k+1) multiply-adds for k columns.
  void add(const std::uint16_t* unknown, const Vec2* column, std::size_t columns, Vec2 residual,
           Sym2 information);

  /// Adds the scalar observation x_k = `residual` (relative to where the unknown is now) with weight 1/sd^2: a prior.
  void add_prior(std::size_t unknown, float residual, float weight);

  /// The step of this unknown will stay in [lower, upper] (lower <= 0 <= upper).
  void set_limits(std::size_t unknown, float lower, float upper);

  /// Solves (H + damping diag(H)) x = g for the step, by scaled Cholesky, within the limits: an unknown that would
  /// leave its limits is put on them and the others are solved again (at most 8 rounds).
  /// An unknown whose scaled pivot falls below 1e-6 is not determined by the observations: it stays, and is counted.
  /// Cost: n^3/6 a round.
  void solve(float damping, float* step);
  std::size_t undetermined_count() const { return undetermined_; }

  /// Diagonal of H^-1 after the last `solve` with damping 0: the variances of the unknowns. Undetermined or limited ones get 0.
  /// Cost: n^3/6.
  void variances(float* variance);

  float h(std::size_t row, std::size_t column) const {
    return row <= column ? h_[index(row, column)] : h_[index(column, row)];
  }
  float g(std::size_t unknown) const { return g_[unknown]; }

 private:
  std::size_t index(std::size_t row, std::size_t column) const {
    return row * count_ - row * (row + 1) / 2 + column;  // row <= column
  }
  void factorise(float damping);
  void back_substitute(const float* right, float* x);

  float *h_ = nullptr, *factor_ = nullptr;
  float *g_ = nullptr, *scale_ = nullptr, *lower_ = nullptr, *upper_ = nullptr, *right_ = nullptr,
        *solution_ = nullptr;
  std::uint8_t* pinned_ = nullptr;
  std::size_t capacity_ = 0, count_ = 0, undetermined_ = 0;
};

/// A nonlinear least-squares problem whose state the caller holds twice: the accepted one and a trial.
struct LeastSquaresProblem {
  void* context;
  /// Cost (half the weighted sum of squares, priors and robust loss included) of the accepted state, and its normal
  /// equations, with limits, into `equations` (reset by the callee).
  float (*linearise)(void* context, NormalEquations& equations);
  /// Makes trial = accepted moved by `step` and returns its cost.
  float (*try_step)(void* context, const float* step);
  /// accepted = trial.
  void (*accept)(void* context);
};

struct SolverOptions {
  int max_iterations = 8;  ///< linearisations
  int max_tries = 4;       ///< dampings tried an iteration
  float initial_damping = 1e-4f;
  float relative_decrease = 1e-5f;  ///< stop when an iteration lowers the cost by less than this share
};

enum class StopReason : std::uint8_t { converged, iteration_limit, no_decrease };

struct SolverReport {
  int iterations = 0;
  StopReason stop_reason = StopReason::iteration_limit;
  float initial_cost = 0, final_cost = 0;
  std::size_t undetermined = 0;
};

/// Levenberg-Marquardt: at most max_iterations x max_tries factorisations. The equations of the last accepted state
/// remain in `equations`.
SolverReport minimise(const LeastSquaresProblem& problem, const SolverOptions& options,
                      NormalEquations& equations, float* step_scratch);

}  // namespace pliant
