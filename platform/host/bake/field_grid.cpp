#include "host/bake/field_grid.hpp"

#include <algorithm>
#include <cmath>

#include "host/bake/at.hpp"
#include "host/io/bounding_box.hpp"

namespace pliant::host::bake {

namespace {

FieldGrid empty_grid(int width, int height, int components) {
  FieldGrid grid;
  grid.width = width;
  grid.height = height;
  grid.components = components;
  grid.samples.assign(at(width) * at(height) * at(components), 0.0f);
  return grid;
}

/// Bounds what a narrow triangle extrapolates: to the range of the values and as much on both sides.
float near_range(float value, float low, float high) {
  const float range = high - low;
  return std::clamp(value, low - range, high + range);
}

}  // namespace

FieldGrid grid_of(const ChartRaster& raster, const std::vector<Vec3>& values) {
  FieldGrid grid = empty_grid(raster.width, raster.height, 3);
  const BoundingBox<Vec3> box(values);
  const Vec3 low = box.low, high = box.high;
  for (std::size_t k = 0; k < raster.samples.size(); ++k) {
    const Vec3 p = value_at(raster.samples[k], values);
    grid.samples[3 * k] = near_range(p.x, low.x, high.x);
    grid.samples[3 * k + 1] = near_range(p.y, low.y, high.y);
    grid.samples[3 * k + 2] = near_range(p.z, low.z, high.z);
  }
  return grid;
}

FieldGrid grid_of(const ChartRaster& raster, const std::vector<float>& values) {
  FieldGrid grid = empty_grid(raster.width, raster.height, 1);
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  for (std::size_t k = 0; k < raster.samples.size(); ++k)
    grid.samples[k] = near_range(value_at(raster.samples[k], values), *low, *high);
  return grid;
}

namespace {

/// Whether the surface is in a cell of which the sample is a corner: its value counts there.
bool is_beside_surface(const ChartRaster& raster, int i, int j) {
  for (int l = std::max(j - 1, 0); l <= std::min(j + 1, raster.height - 1); ++l)
    for (int k = std::max(i - 1, 0); k <= std::min(i + 1, raster.width - 1); ++k)
      if (raster.at(k, l).triangle >= 0) return true;
  return false;
}

}  // namespace

void clear_border(FieldGrid& grid, const ChartRaster& raster) {
  const auto n = at(grid.components);
  for (int j = 0; j < grid.height; ++j)
    for (int i = 0; i < grid.width; ++i) {
      const bool border = i == 0 || j == 0 || i == grid.width - 1 || j == grid.height - 1;
      if (border && !is_beside_surface(raster, i, j))
        std::fill_n(grid.samples.begin() + static_cast<std::ptrdiff_t>(at(j * grid.width + i) * n), n, 0.0f);
    }
}

FieldGrid cropped(const FieldGrid& grid, float threshold) {
  int left = grid.width, right = -1, top = grid.height, bottom = -1;
  for (int j = 0; j < grid.height; ++j)
    for (int i = 0; i < grid.width; ++i)
      for (int c = 0; c < grid.components; ++c)
        if (std::fabs(grid.samples[at((j * grid.width + i) * grid.components + c)]) > threshold) {
          left = std::min(left, i);
          right = std::max(right, i);
          top = std::min(top, j);
          bottom = std::max(bottom, j);
        }
  if (left == 0 || top == 0 || right == grid.width - 1 || bottom == grid.height - 1) return grid;
  if (right < 0) left = right = top = bottom = 1;
  FieldGrid cut = empty_grid(right - left + 3, bottom - top + 3, grid.components);
  const float w = static_cast<float>(grid.width - 1), h = static_cast<float>(grid.height - 1);
  cut.u0 = static_cast<float>(left - 1) / w;
  cut.u1 = static_cast<float>(right + 1) / w;
  cut.v0 = static_cast<float>(top - 1) / h;
  cut.v1 = static_cast<float>(bottom + 1) / h;
  for (int j = top; j <= bottom; ++j)
    for (int i = left; i <= right; ++i)
      for (int c = 0; c < grid.components; ++c)
        cut.samples[at(((j - top + 1) * cut.width + i - left + 1) * grid.components + c)] =
            grid.samples[at((j * grid.width + i) * grid.components + c)];
  return cut;
}

float sample(const FieldGrid& grid, int component, Vec2 uv) {
  const float x = (uv.x - grid.u0) * static_cast<float>(grid.width - 1) / (grid.u1 - grid.u0);
  const float y = (uv.y - grid.v0) * static_cast<float>(grid.height - 1) / (grid.v1 - grid.v0);
  if (!(x >= 0 && y >= 0 && x <= static_cast<float>(grid.width - 1) &&
        y <= static_cast<float>(grid.height - 1)))
    return 0;
  const int i = std::min(static_cast<int>(x), grid.width - 2),
            j = std::min(static_cast<int>(y), grid.height - 2);
  const float a = x - static_cast<float>(i), b = y - static_cast<float>(j);
  const auto value = [&](int k, int l) {
    return grid.samples[at(((j + l) * grid.width + i + k) * grid.components + component)];
  };
  const float upper = value(0, 0) + a * (value(1, 0) - value(0, 0));
  const float lower = value(0, 1) + a * (value(1, 1) - value(0, 1));
  return upper + b * (lower - upper);
}

}  // namespace pliant::host::bake
