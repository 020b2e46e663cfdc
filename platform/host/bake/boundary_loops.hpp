#pragma once
/// \file boundary_loops.hpp
/// Loops of boundary edges of a mesh over a chart.
#include <vector>

#include "pliant/geometry.hpp"

namespace pliant::host::bake {

/// Follows the boundary edges from vertex to vertex.
/// \param next  one a vertex: where the boundary edge from it ends, or -1
/// \return the vertices of each loop in order, the smallest first; the loops in the order of their first vertices.
std::vector<std::vector<int>> trace_loops(std::vector<int> next);

/// Twice the area that a loop encloses in the chart. Its sign is the loop's direction, and is right for the smallest openings
/// too: the products of two floats are exact.
double doubled_loop_area(const std::vector<Vec2>& uv, const std::vector<int>& loop);

}  // namespace pliant::host::bake
