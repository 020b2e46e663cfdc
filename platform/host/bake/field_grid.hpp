#pragma once
/// \file field_grid.hpp
/// A field as floats on a grid over a rectangle of the chart, before it is quantised.
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

/// Samples values given at the vertices on a grid over the whole chart. Precondition: there are values.
FieldGrid grid_of(const ChartRaster& raster, const std::vector<Vec3>& values);
FieldGrid grid_of(const ChartRaster& raster, const std::vector<float>& values);

/// Sets those samples on the border of the chart to zero that no triangle covers.
void clear_border(FieldGrid& grid, const ChartRaster& raster);

/// The smallest part of the grid that holds every sample larger than `threshold`, with a border of zeros around it. The
/// whole grid if a sample on the border of the chart is larger. 3 x 3 zeros if no sample is.
FieldGrid cropped(const FieldGrid& grid, float threshold);

/// Bilinear value of component c at (u,v), zero outside the rectangle.
float sample(const FieldGrid& grid, int component, Vec2 uv);

}  // namespace pliant::host::bake
