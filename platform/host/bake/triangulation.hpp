#pragma once
/// \file triangulation.hpp
/// Triangles over points of the chart that respect given boundary loops, shaped by lengths on the surface.
#include <array>
#include <functional>
#include <vector>

#include "pliant/geometry.hpp"

namespace pliant::host::bake {

/// A planar domain: closed loops of point indices, the outer first, each without its first point repeated. No
/// two loops touch or cross.
struct Domain {
  std::vector<Vec2> points;             ///< all points, those of the loops included
  std::vector<std::vector<int>> loops;  ///< the outer one, then the holes'; any direction
};

using Triangles = std::vector<std::array<int, 3>>;

/// Constrained Delaunay triangulation of the domain in the plane: every edge of the loops is an edge of the
/// result, nothing outside the outer loop or in a hole. Positive area throughout. Empty when the loops cross.
/// Cost: O(n^2).
Triangles triangulate(const Domain& domain);

/// Flips inner edges until each is as Delaunay by the positions in space as the plane allows. Positive areas
/// are kept.
void flip_by_shape(Triangles& triangles, const std::vector<Vec2>& uv, const std::vector<Vec3>& position);

}  // namespace pliant::host::bake
