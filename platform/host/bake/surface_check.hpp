#pragma once
/// \file surface_check.hpp
/// Checks that a mesh is a surface over a chart: every edge has at most two faces, the faces at a vertex form one fan, and no
/// point of the chart belongs to two points of the surface.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "pliant/geometry.hpp"

namespace pliant::host::bake {

struct SurfaceDefect {
  std::string what;
  std::size_t triangle;  ///< where it was found
};

/// Finds the first defect of a mesh, if there is one. All (u,v) are in [0,1].
/// \param triangles  counter-clockwise seen from outside, v downwards: of negative area in the chart.
/// Cost: n log n for n triangles; with b boundary edges about b^1.5, and b^2 where they all cross one place.
std::optional<SurfaceDefect> find_defect(const std::vector<Vec2>& uv,
                                         const std::vector<std::array<int, 3>>& triangles);

}  // namespace pliant::host::bake
