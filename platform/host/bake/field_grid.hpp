#pragma once
/// \file field_grid.hpp
/// A field as floats on a grid, cut to its support, before it is quantised.
#include <vector>

#include "host/bake/chart_raster.hpp"

namespace pliant::host::bake {

/// Samples (i,j), component c at samples[(j * width + i) * components + c], over the rectangle [u0,u1] x
/// [v0,v1].
struct FieldGrid {
  int width = 0, height = 0, components = 0;
  float u0 = 0, v0 = 0, u1 = 1, v1 = 1;
  std::vector<float> samples;
  bool is_whole_chart() const { return u0 == 0 && v0 == 0 && u1 == 1 && v1 == 1; }
};

/// What is given at the vertices, over the whole chart.
FieldGrid grid_of(const ChartRaster& raster, const std::vector<Vec3>& values);
FieldGrid grid_of(const ChartRaster& raster, const std::vector<float>& values);

/// Makes the samples on the border of the chart zero that do not lie on the mesh.
void clear_border(FieldGrid& grid, const ChartRaster& raster);

/// The grid cut to where it is larger than `threshold`, with a rim of zeros around it; the whole grid when it
/// is larger than that on the border of the chart. Three by three zeros when nothing is left.
FieldGrid cropped(const FieldGrid& grid, float threshold);

/// Bilinear value of component c at (u,v), zero outside the rectangle.
float sample(const FieldGrid& grid, int component, Vec2 uv);

}  // namespace pliant::host::bake
