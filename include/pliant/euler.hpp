#pragma once
/// \file euler.hpp
/// The published dynamics: gradient descent along the generalised force (Eq. 9, 12, 13; docs/algorithms.md,
/// section 5.1).
#include <cstdint>

#include "pliant/solver.hpp"

namespace pliant {

/// How the length of a step along the generalised force is chosen.
enum class EulerStep : std::uint8_t {
  /// Eq. 13: q += delta (K q + f_g) with a fixed delta. Stable only for delta < 2 / lambda_max(H). That bound
  /// falls with the number of points and with the square of the image scale.
  published,
  /// q_k += delta (K q + f_g)_k / H_kk. delta = 1 / the largest absolute row sum of D^-1/2 H D^-1/2, D = diag(H), which
  /// bounds its largest eigenvalue (Gershgorin). Independent of units and of the number of points. A step that raises
  /// the cost is refused and delta is halved.
  preconditioned,
  /// The direction of `preconditioned`; delta from the last two gradients (Barzilai and Borwein 1988). A step
  /// is accepted when the cost stays below the highest of the last ten.
  barzilai_borwein,
};

/// Options of integrate.
struct EulerOptions {
  EulerStep step = EulerStep::published;  ///< how its length is chosen
  float delta = 1e-3f;                    ///< step length of `published`, the paper's value
  int steps = 600;                        ///< at most; the paper's value
  /// Stop when 30 steps lower the cost by less than this fraction. 0: never.
  float relative_decrease = 0;
};

/// Integrates the published dynamics on a least-squares problem.
/// The stiffness K of Eq. 12 is the problem's own prior, K = -diag(1 / sd^2), and part of g. Steps stay
/// within the limits of the equations. `iterations` of the report counts steps. The result is `diverged` when
/// the cost is no longer a number; the accepted state is then the last one with a finite cost.
/// \param scratch  3 floats an unknown.
/// Cost: a linearisation of the gradient a step; the first one includes H unless the step is `published`.
SolverReport integrate(const LeastSquaresProblem& problem, const EulerOptions& options,
                       NormalEquations& equations, float* scratch);

}  // namespace pliant
