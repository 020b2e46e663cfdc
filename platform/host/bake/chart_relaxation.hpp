#pragma once
/// \file chart_relaxation.hpp
/// Evens out a chart so that no part of the surface is crushed into a few samples.
#include <array>
#include <vector>

#include "pliant/geometry.hpp"

namespace pliant::host::bake {

/// Scales the chart to the unit square, then moves its inner vertices so that the surface's stretch over the chart
/// decreases (the L2 norm of Sander, Snyder, Gortler and Hoppe 2001). Vertices on a boundary, those of openings included,
/// are only scaled. No triangle changes its orientation.
/// \param triangles  counter-clockwise seen from outside, v downwards: of negative area in the chart.
/// \param sweeps     passes over all vertices; 200 is a round value. A face whose chart crushes the nostrils was then nine
///                   times as accurate at the same size of the table.
/// Cost: about 60 evaluations a vertex and sweep.
void relax_chart(std::vector<Vec2>& uv, const std::vector<Vec3>& position,
                 const std::vector<std::array<int, 3>>& triangles, int sweeps = 200);

}  // namespace pliant::host::bake
