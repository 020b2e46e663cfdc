#pragma once
// The initial view of a fit (docs/algorithms.md, section 4.4).
#include "fit/fit_problem.hpp"

namespace pliant {

/// Finds problem.view from the points. Minimises over the pose alone from two weak-perspective solutions and three turned
/// views; the lowest robust cost wins.
/// \pre the shape is held. \param centre  principal point, px.
void find_initial_view(FitProblem& problem, Vec2 centre);

}  // namespace pliant
