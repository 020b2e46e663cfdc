#pragma once
// The initial view of a fit (docs/algorithms.md, section 4.4).
#include "fit/fit_problem.hpp"

namespace pliant {

/// Finds problem.view from the points. Minimises over the pose alone from two weak-perspective solutions and three turned
/// views; the lowest robust cost wins.
/// \param position  the points on the model at the present parameters, mm.
/// \param centre    principal point, px.
void find_initial_view(FitProblem& problem, const Vec3* position, Vec2 centre);

}  // namespace pliant
