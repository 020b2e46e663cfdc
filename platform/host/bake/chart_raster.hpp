#pragma once
/// \file chart_raster.hpp
/// Which triangle of a mesh lies under each sample of a grid over the chart.
#include <array>
#include <cstdint>
#include <vector>

#include "pliant/geometry.hpp"

namespace pliant::host::bake {

/// Three vertices and their weights, which give a sample's value. The weights add up to one. Outside the mesh they
/// extrapolate the nearest triangle or repeat the nearest sample.
struct ChartSample {
  std::array<int, 3> vertex;
  std::array<float, 3> weight;
  std::int32_t triangle;  ///< under the sample; -1 outside the surface
};

/// A grid with sample (i,j) at u = i / (width - 1), v = j / (height - 1); rows from v = 0.
struct ChartRaster {
  int width, height;
  std::vector<ChartSample> samples;
  const ChartSample& at(int i, int j) const { return samples[static_cast<std::size_t>(j * width + i)]; }
};

/// The triangles of the surface cover their samples first. Triangles of holes cover the samples that are more than one
/// sample away from the surface.
ChartRaster rasterise(const std::vector<Vec2>& uv, const std::vector<std::array<int, 3>>& triangles,
                      const std::vector<char>& is_hole, int width, int height);

/// Twice the signed area of each triangle over (u,v). The chart is injective only if all have one sign.
std::vector<float> chart_areas(const std::vector<Vec2>& uv, const std::vector<std::array<int, 3>>& triangles);

/// Interpolates values given at the vertices at a sample.
template <class T>
T value_at(const ChartSample& s, const std::vector<T>& values) {
  T value{};
  for (std::size_t k = 0; k < 3; ++k)
    value = value + s.weight[k] * values[static_cast<std::size_t>(s.vertex[k])];
  return value;
}

}  // namespace pliant::host::bake
