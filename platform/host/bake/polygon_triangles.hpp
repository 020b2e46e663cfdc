#pragma once
/// \file polygon_triangles.hpp
/// Splits polygons of a mesh into triangles.
#include <array>
#include <vector>

#include "pliant/geometry.hpp"

namespace pliant::host::bake {

/// Triangles of a polygon, with its winding: the fan around its first corner if that is good enough. Otherwise of up to 64 corners
/// those that are least narrow, in the chart and in space, all of one winding in the chart where there are such; corners may lie on
/// a straight line. Of more corners the fan with the largest least area in the chart.
/// \param corners   at least three vertices
/// \param uv, position  of all vertices
/// Cost: O(n) or, where that fan is not taken, O(n^3) up to 64 corners.
std::vector<std::array<int, 3>> triangles_of(const std::vector<int>& corners, const std::vector<Vec2>& uv,
                                             const std::vector<Vec3>& position);

}  // namespace pliant::host::bake
