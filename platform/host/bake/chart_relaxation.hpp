#pragma once
/// \file chart_relaxation.hpp
/// A chart that gives every part of the surface its share of samples.
#include <array>
#include <vector>

#include "pliant/geometry.hpp"

namespace pliant::host::bake {

/// Stretches the chart to the unit square, and moves the vertices inside it so that the surface's stretch over the
/// chart (Sander, Snyder, Gortler and Hoppe 2001, the L2 norm) becomes less: what was crushed into a few samples gets
/// room. Vertices on a boundary, openings included, only take part in the first. No triangle turns over.
/// \param triangles  counter-clockwise seen from outside, v downwards: of negative area in the chart.
/// Cost: about 60 evaluations a vertex and sweep.
void relax_chart(std::vector<Vec2>& uv, const std::vector<Vec3>& position,
                 const std::vector<std::array<int, 3>>& triangles, int sweeps = 200);

/// Root of the surface's mean squared stretch, mm a unit of the chart; the least is the root of its area over the
/// chart's.
double chart_stretch(const std::vector<Vec2>& uv, const std::vector<Vec3>& position,
                     const std::vector<std::array<int, 3>>& triangles);

}  // namespace pliant::host::bake
