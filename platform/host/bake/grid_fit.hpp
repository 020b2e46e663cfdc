#pragma once
/// \file grid_fit.hpp
/// Fits the samples of a grid to a mesh by least squares.
#include <vector>

#include "host/bake/field_grid.hpp"

namespace pliant::host::bake {

/// A place in the chart at which a grid is compared with the mesh, and the vertices and weights that give the mesh's value
/// there.
struct FitPlace {
  Vec2 uv;
  ChartSample source;
};

/// The vertices of the surface, and the centres of its triangles that are at least half as large as a cell of a grid with
/// `side` samples on each side.
std::vector<FitPlace> fit_places(const std::vector<Vec2>& uv,
                                 const std::vector<std::array<int, 3>>& triangles,
                                 const std::vector<char>& is_hole, int side);

/// Corrects the samples of a grid over the whole chart: minimises the squared differences between its bilinear values and
/// `values` (one value or vector a vertex) at the places, plus the squared Laplacian of the correction. A sample that is
/// zero and whose correction is at most `threshold` remains zero. Cost: at most 24 iterations over samples and places for
/// each component.
void fit_grid(FieldGrid& grid, const std::vector<FitPlace>& places, const std::vector<Vec3>& values,
              float threshold);
void fit_grid(FieldGrid& grid, const std::vector<FitPlace>& places, const std::vector<float>& values,
              float threshold);

}  // namespace pliant::host::bake
