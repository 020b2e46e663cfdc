#pragma once
// Tuning of the search for the minimum covariance determinant (outliers.hpp).
#include <cstddef>

namespace pliant::mcd {

struct Tuning {
  /// C-steps of one path, count, at most. Three to ten are usual; the limit bounds the time. Round value.
  int c_steps = 100;
  /// Two determinants closer than this fraction are those of one subset. Between the rounding of doubles (1e-14) and the
  /// difference that one row makes. Not tuned.
  double same_determinant = 1e-11;
  /// Determinants that a search remembers, to stop where an earlier path has been, count. Not tuned.
  std::size_t remembered = 64;
  /// FAST-MCD: rows of a group, and groups, as published (Rousseeuw & Van Driessen 1999).
  std::size_t group_rows = 300, groups = 5;
  /// FAST-MCD: candidates kept of each group, as published.
  std::size_t kept = 10;
  /// DetMCD: Jacobi sweeps of the eigenvectors, count. Six to eight converge for 24 columns. Not tuned.
  int jacobi_sweeps = 12;
  /// DetMCD: smallest scale along an axis, of standardised data. Keeps a flat direction from having infinite weight.
  double smallest_scale = 1e-6;
  /// Smallest relative gain of an exchange, of the determinant. Above the rounding of the update. Not tuned.
  double least_gain = 1e-9;
  /// Selection by digits ends below this many values, count; the rest is sorted. Only the speed depends on it. Not tuned.
  std::size_t sorted_directly = 48;
};
inline constexpr Tuning kTuning{};

/// Deviation of Gaussian data over its median absolute deviation: 1 / quantile(3/4) of the normal distribution.
inline constexpr double kMadToDeviation = 1.4826;

}  // namespace pliant::mcd
