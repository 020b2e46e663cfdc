#pragma once
/// \file grid_fit.hpp
/// Makes a grid true to the mesh that it was sampled from: least squares over its samples.
#include <vector>

#include "host/bake/field_grid.hpp"

namespace pliant::host::bake {

/// Where a grid over the whole chart is compared with the mesh: places in the chart, and vertices with their
/// weights there.
struct FitPlace {
  Vec2 uv;
  ChartSample source;
};

/// Vertices of the skin, and the centres of triangles that are not much smaller than a cell of `side` samples
/// a side.
std::vector<FitPlace> fit_places(const std::vector<Vec2>& uv,
                                 const std::vector<std::array<int, 3>>& triangles,
                                 const std::vector<char>& is_hole, int side);

/// Moves the samples of a grid over the whole chart so that its bilinear values come closest to `values` (one
/// a vertex, or three components of one) at the places, and otherwise as smoothly as can be. Samples that were zero and would stay below `still` remain zero. Cost: 24 rounds over samples and
/// places a component.
void fit_grid(FieldGrid& grid, const std::vector<FitPlace>& places, const std::vector<Vec3>& values,
              float still);
void fit_grid(FieldGrid& grid, const std::vector<FitPlace>& places, const std::vector<float>& values,
              float still);

}  // namespace pliant::host::bake
