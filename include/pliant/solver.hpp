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
///
/// Observations with most of the columns are gathered, eight at a time, as rows of L^T B (W = L L^T), and added as one
/// product in tiles that stay in registers; sparse ones are added one by one. The bits depend on the order of the calls alone.
/// Bytes: 2 x 4 x n(n+1)/2, 18 rows of n + 8 floats, and 7 floats and 3 bytes an unknown.
class NormalEquations {
 public:
  void lay_out(Arena& arena, std::size_t unknowns);
  std::size_t capacity() const { return capacity_; }
  std::size_t count() const { return count_; }

  /// Starts over with `count` unknowns, at most capacity(). No limits.
  void reset(std::size_t count);

  /// Of what is added from now on, keeps g and the diagonal of H alone (until told otherwise): all that a step along
  /// the generalised force needs. Cost of an observation: O(k) instead of O(k^2).
  void keep_gradient_only(bool only) { gradient_only_ = only; }

  /// Adds one image observation: residual f = observed - projected (px), information W (1/px^2, may be of rank one),
  /// and the 2 x n derivative of the projection by its non-zero columns: unknown numbers ascending.
  /// Cost: k(k+1) multiply-adds for k columns, or n(n+1) in lanes where k is most of n.
  void add(const std::uint16_t* unknown, const Vec2* column, std::size_t columns, Vec2 residual,
           Sym2 information);
  /// The same with all of the columns, as the two rows of the derivative: count() floats each.
  void add_dense(const float* along_x, const float* along_y, Vec2 residual, Sym2 information);

  /// Adds the scalar observation x_k = `residual` (relative to where the unknown is now) with weight 1/sd^2: a prior.
  void add_prior(std::size_t unknown, float residual, float weight);

  /// The step of this unknown will stay in [lower, upper] (lower <= 0 <= upper).
  void set_limits(std::size_t unknown, float lower, float upper);
  float clamped(std::size_t unknown, float step) const {
    return clamp(step, lower_[unknown], upper_[unknown]);
  }

  /// Solves (H + damping diag(H)) x = g for the step, by scaled Cholesky, within the limits: an unknown that would
  /// leave its limits is put on them and the others are solved again, one that they then pull back inside is set free
  /// (at most 12 rounds).
  /// An unknown whose scaled pivot falls below 1e-6 is not determined by the observations: it stays, and is counted.
  /// Cost: n^3/6 a round.
  void solve(float damping, float* step);
  std::size_t undetermined_count() const { return undetermined_; }

  /// Diagonal of H^-1 after the last `solve` with damping 0: the variances of the unknowns. Undetermined ones get 0;
  /// limits count for nothing.
  /// Cost: n^3/6.
  void variances(float* variance);

  /// An element of H; g = f_g. Only the diagonal while keep_gradient_only.
  float h(std::size_t row, std::size_t column) {
    if (gathered_ > 0) flush();
    return row <= column ? h_[index(row, column)] : h_[index(column, row)];
  }
  float g(std::size_t unknown) {
    if (gathered_ > 0) flush();
    return g_[unknown];
  }

 private:
  std::size_t index(std::size_t row, std::size_t column) const {
    return row * count_ - row * (row + 1) / 2 + column;  // row <= column
  }
  float* gathered_row(float residual);
  void add_sparse(const std::uint16_t* unknown, const Vec2* column, std::size_t columns, Vec2 residual,
                  Sym2 w);
  void flush();
  void add_tile(std::size_t row, std::size_t column);
  void start_scaled();
  void copy_scaled(float damping);
  void factorise(float damping);
  float* factor_row(std::size_t i);
  void pin_undetermined(std::size_t k);
  void pin_pushed_out();
  bool pin_to_limits(float* step);
  bool release_from_limits(float damping, const float* step);
  void back_substitute(const float* right, float* x);

  float *h_ = nullptr, *factor_ = nullptr, *rows_ = nullptr, *row_residual_ = nullptr;
  float *spread_x_ = nullptr, *spread_y_ = nullptr;  // the rows of one sparse observation
  float *g_ = nullptr, *scale_ = nullptr, *lower_ = nullptr, *upper_ = nullptr, *right_ = nullptr,
        *solution_ = nullptr, *compact_ = nullptr;
  std::uint8_t* pinned_ = nullptr;  // 1: to a limit; 2: undetermined
  std::uint16_t* free_ = nullptr;   // the others, ascending: of these is the factor
  std::size_t capacity_ = 0, count_ = 0, free_count_ = 0, undetermined_ = 0;
  std::size_t stride_ = 0, gathered_ = 0;  // of rows_
  bool gradient_only_ = false;
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
  /// Linearise once more where it ends, so that `equations` are those of the last accepted state. Saves one of the
  /// linearisations when nobody reads them.
  bool leave_equations = true;
};

enum class StopReason : std::uint8_t { converged, iteration_limit, no_decrease, diverged };

struct SolverReport {
  int iterations = 0;
  StopReason stop_reason = StopReason::iteration_limit;
  float initial_cost = 0, final_cost = 0;
  std::size_t undetermined = 0;
};

/// Levenberg-Marquardt: at most max_iterations x max_tries factorisations. The equations of the last accepted state
/// remain in `equations`, unless options.leave_equations is false.
SolverReport minimise(const LeastSquaresProblem& problem, const SolverOptions& options,
                      NormalEquations& equations, float* step_scratch);

/// How long a step along the generalised force is (ALGORITHMS: section 5.1).
enum class EulerStep : std::uint8_t {
  /// Eq. 13: q += delta (K q + f_g), delta as given, whatever becomes of it. Stable only where delta < 2 / lambda_max(H),
  /// which shrinks with the number of points and the square of pixels per unit.
  published,
  /// q_k += delta (K q + f_g)_k / H_kk, delta = 1 / the largest absolute row sum of D^-1/2 H D^-1/2 (Gershgorin's
  /// bound of its largest eigenvalue, at most n): free of units and of the number of points. A step that raises the cost
  /// is taken back and delta halved.
  preconditioned,
  /// The same direction; delta from the last two gradients (Barzilai and Borwein), accepted while the cost stays below the
  /// highest of the last ten.
  barzilai_borwein,
};

struct EulerOptions {
  EulerStep step = EulerStep::published;
  float delta = 1e-3f;          ///< of `published`
  int steps = 600;              ///< at most
  float relative_decrease = 0;  ///< stop when 30 steps lower the cost by less than this share; 0: never
};

/// The published dynamics (Eq. 9, 12, 13) on the same problem: gradient descent. The stiffness K of Eq. 12 is the
/// problem's own prior, K = -diag(1 / sd^2), part of g. Steps stay within the limits of the equations.
/// report.iterations counts steps. Stops with `diverged` where the cost is no number any more, at the last state that had one.
/// \param scratch  3 floats an unknown.
/// Cost: a linearisation a step, of the gradient alone; of H as well in the first where the step is not `published`.
SolverReport integrate(const LeastSquaresProblem& problem, const EulerOptions& options,
                       NormalEquations& equations, float* scratch);

}  // namespace pliant
