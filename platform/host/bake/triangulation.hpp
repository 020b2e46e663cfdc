#pragma once
/// \file triangulation.hpp
/// Constrained Delaunay triangulation in the chart, and edge flips by the triangles' shape in space.
#include <array>
#include <vector>

#include "pliant/geometry.hpp"

namespace pliant::host::bake {

/// A planar domain bounded by closed loops of point indices, each without its first point repeated. No two loops touch or
/// intersect.
struct Domain {
  std::vector<Vec2> points;             ///< all points, those of the loops included
  std::vector<std::vector<int>> loops;  ///< the outer loop, then those of the holes; in any direction
};

using Triangles = std::vector<std::array<int, 3>>;

/// Constrained Delaunay triangulation: every edge of the loops is an edge of the result, which covers the domain once. All
/// triangles are counter-clockwise; those between points on one line may have no area. Empty if the loops intersect. Cost:
/// O(n^2).
Triangles triangulate(const Domain& domain);

/// Flips inner edges until each is Delaunay by the positions in space. An edge is kept if a triangle of the flipped pair would
/// have less than a tenth of their area in the chart. At most 20 passes over the edges.
void flip_by_shape(Triangles& triangles, const std::vector<Vec2>& uv, const std::vector<Vec3>& position);

}  // namespace pliant::host::bake
