#pragma once
/// \file chart_raster.hpp
/// Which triangle of a mesh lies under each sample of a grid over the chart.
#include <array>
#include <cstdint>
#include <vector>

#include "pliant/geometry.hpp"

namespace pliant::host::bake {

/// How a sample's value follows from the mesh: three vertices and their weights, which add up to one. Outside
/// the mesh they continue the nearest triangle.
struct ChartSample {
  std::array<int, 3> vertex;
  std::array<float, 3> weight;
  std::int32_t triangle;  ///< under the sample, or -1 beside the skin and outside the mesh
};

/// A grid with sample (i,j) at u = i / (width - 1), v = j / (height - 1); rows from v = 0.
struct ChartRaster {
  int width, height;
  std::vector<ChartSample> samples;
  const ChartSample& at(int i, int j) const { return samples[static_cast<std::size_t>(j * width + i)]; }
};

/// The triangles of the skin come first; those of holes take what is more than a sample away from it.
ChartRaster rasterise(const std::vector<Vec2>& uv, const std::vector<std::array<int, 3>>& triangles,
                      const std::vector<char>& is_hole, int width, int height);

/// Twice the signed area over (u,v) of each triangle: the chart is injective where all have one sign.
std::vector<float> chart_areas(const std::vector<Vec2>& uv, const std::vector<std::array<int, 3>>& triangles);

/// The value at a sample of what is given at the vertices.
template <class T>
T value_at(const ChartSample& s, const std::vector<T>& values) {
  T value{};
  for (std::size_t k = 0; k < 3; ++k)
    value = value + s.weight[k] * values[static_cast<std::size_t>(s.vertex[k])];
  return value;
}

}  // namespace pliant::host::bake
