#pragma once
// The last stage of both searches: C-steps on all rows, in double, from a start to convergence.
#include "optim/mcd_kernel.hpp"

namespace pliant::mcd {

inline constexpr std::size_t kRemembered = 64;
inline constexpr std::size_t kGroups = 5, kKept = 10;
inline constexpr std::size_t kCandidates = kKept * (kGroups + 1);  // shapes whose room `Mcd` has

struct Search {
  Cloud cloud;
  std::size_t subset_size;
  Scratch scratch;
  std::uint16_t* best;
  ScaledNumber* seen;  // the last kRemembered determinants
  bool found = false;
  ScaledNumber best_determinant = {};
  std::size_t steps = 0;
  std::size_t seen_count = 0;

  /// C-steps from `shape` until the determinant is one seen before: on this path, which has converged, or on
  /// an earlier one, which this path has joined. Keeps the best subset.
  void converge(Shape<double>& shape);

  /// Goes on from the best subset with exchanges of one row near the border inside for one outside, each
  /// followed by C-steps, until none of them lowers the determinant or `rounds` are used up.
  void exchange(std::size_t rounds);
};

}  // namespace pliant::mcd
