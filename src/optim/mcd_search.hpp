#pragma once
// The last stage of both searches: C-steps on all rows, in double, from a start to convergence.
#include "optim/mcd_kernel.hpp"

namespace pliant::mcd {

inline constexpr std::size_t kRemembered = kTuning.remembered;
inline constexpr std::size_t kGroups = kTuning.groups, kKept = kTuning.kept;
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

  /// Makes C-steps from `shape` until the determinant is one seen before: then the path has converged, or has joined an
  /// earlier path. Keeps the best subset.
  void converge(Shape<double>& shape);

  /// Exchanges one row of the best subset for one outside, both near the border, and makes C-steps; repeats until no
  /// exchange lowers the determinant, at most `rounds` times.
  void exchange(std::size_t rounds);
};

}  // namespace pliant::mcd
