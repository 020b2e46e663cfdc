#pragma once
// Tuned constants of the normal equations.
#include <cstddef>

namespace pliant {

/// Tuning of the solve and of its accumulation.
struct NormalEquationsTuning {
  /// Pivot of the matrix with unit diagonal below which an unknown is undetermined. Near
  /// the rounding error of a float factorisation (docs/algorithms.md, section 5.5). Round value, not tuned.
  float least_pivot = 1e-6f;
  /// Rounds of setting unknowns to their limits, count. It bounds the time of a solve. Round value, not tuned.
  int limit_rounds = 12;
  /// Fraction of the largest scaled force with which an unknown must be pulled inside before it leaves its limit. Smaller
  /// forces are rounding errors of the step. Round value, not tuned.
  float releasing_force = 1e-3f;
  /// Rows collected before they are added to H, count, and the tile of H that stays in registers meanwhile. The
  /// tile fills the registers of SSE and NEON. Chosen by the times of `pliant bench fit`.
  std::size_t gathered_rows = 16, tile_rows = 4, tile_columns = 8;
  /// An observation with columns for at least 5/8 of the unknowns is added densely. Measured as above.
  std::size_t dense_numerator = 5, dense_denominator = 8;
  /// Pivots whose rows are applied to the remaining matrix together, count. Measured as above.
  std::size_t panel = 4;
};
inline constexpr NormalEquationsTuning kNormalEquationsTuning{};

}  // namespace pliant
