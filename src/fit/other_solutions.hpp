#pragma once
// Other solutions of a fit (docs/algorithms.md, section 4.4). From afar a shallow surface looks much the same if it is tilted the
// other way and bent the other way, and a fit ends in the solution that it starts near.
#include "fit/fit_problem.hpp"
#include "fit/fold_over_guard.hpp"

namespace pliant {

/// Tries other states than the one that a fit has found. Keeps three copies of the parameters.
class OtherSolutions {
 public:
  void lay_out(Arena& arena, const Model& model);
  /// Notes the parameters at which a fit starts.
  void start(const float* q);
  /// Minimises from other states too, where few points or large residuals call for it. One that fits clearly better becomes the
  /// problem's state; else nothing changes.
  /// \param shapes  gives the positions of the base mesh's vertices. \return whether one is better.
  bool find_better(FitProblem& problem, FoldOverGuard& shapes);

 private:
  void set_state(FitProblem& problem, const View& first, Vec3 normal, int k) const;

  std::size_t parameters_ = 0;
  float *start_q_ = nullptr, *first_q_ = nullptr, *best_q_ = nullptr;
};

}  // namespace pliant
