// Samples each shape on a grid, crops the grid, and chooses its resolution.
#include "host/bake/shape_grids.hpp"

#include <algorithm>
#include <cmath>

#include "host/bake/at.hpp"
#include "host/io/bounding_box.hpp"

namespace pliant::host::bake {

namespace {

/// Tuning of the fields' resolution. Each constant: unit, reason, experiment.
struct FieldTuning {
  /// Samples on a side of the coarsest grid, count. Fewer cannot hold the support of a lip or a lid. Round value, not tuned.
  int least_side = 16;
  /// Standard deviations at which the error of an identity is judged. Two cover 95 % of people.
  float identity_sds = 2;
  /// Distance from the axis at which the error of a rotation's weight is judged, millimetres: the chin's from the jaw's hinge.
  float rotation_arm_mm = 80;
  /// Motion below which a sample counts as zero, millimetres, at the parameter's largest value. Grids are cropped to the
  /// other samples. A tenth of the tolerance, so that the error of cropping is negligible. Not tuned further.
  float still_mm = 0.004f;
  /// Diagonal of a surface for which these lengths and the tolerance hold, millimetres, up to ten times as much. Those of a
  /// surface ten times as large are ten times as large.
  float diagonal_mm = 100;
};
constexpr FieldTuning kTuning{};

float largest_excess(const std::vector<float>& of, const std::vector<float>& over) {
  float excess = 0;
  for (std::size_t i = 0; i < of.size(); ++i) excess = std::max(excess, of[i] - over[i]);
  return excess;
}

}  // namespace

ShapeGrids::ShapeGrids(const Source& source, const std::vector<std::size_t>& surface, int size,
                       float tolerance_mm)
    : source_(source),
      surface_(surface),
      size_(size),
      tolerance_mm_(tolerance_mm),
      places_(fit_places(source.uv, source.triangles, source.is_hole, size)) {
  for (int side = size; side >= kTuning.least_side; side = (side + 1) / 2) rasters_.push_back(raster(side));
  BoundingBox<Vec3> box;
  for (const std::size_t v : surface_) box.add(source.neutral[v]);
  diagonal_ = length(box.size());
  while (diagonal_ > 10 * kTuning.diagonal_mm * scale_) scale_ *= 10;
  while (diagonal_ < kTuning.diagonal_mm * scale_ && scale_ > 1e-6f) scale_ /= 10;
}

FieldGrid ShapeGrids::rest_shape() const {
  FieldGrid grid = grid_of(raster(2 * size_), source_.neutral);
  fit_grid(grid, places_, source_.neutral, 0);
  return grid;
}

FieldGrid ShapeGrids::shape(const SourceShape& shape) const {
  return shape.weight.empty() ? grid_for(shape.displacement, shape) : grid_for(shape.weight, shape);
}

GreyImage ShapeGrids::mask() const {
  const ChartRaster fine = raster(2 * size_);
  GreyImage image{static_cast<std::uint32_t>(fine.width), static_cast<std::uint32_t>(fine.height), {}};
  for (const ChartSample& s : fine.samples)
    image.pixels.push_back(s.triangle >= 0 && !source_.is_hole[at(s.triangle)] ? 1 : 0);
  return image;
}

ChartRaster ShapeGrids::raster(int side) const {
  return rasterise(source_.uv, source_.triangles, source_.is_hole, side, side);
}

/// The value of a parameter at which the error of its shape is judged.
float ShapeGrids::most_of(std::size_t parameter) const {
  const SourceParameter& p = source_.parameters[parameter];
  const float most = std::abs(p.farthest());
  return p.group == Group::identity ? std::min(kTuning.identity_sds * p.sd, most) : most;
}

template <class T>
FieldGrid ShapeGrids::grid_for(const std::vector<T>& values, const SourceShape& shape) const {
  const float most = most_of(shape.parameter) * (shape.second >= 0 ? most_of(at(shape.second)) : 1.0f);
  const float effect = std::max(most, 1e-6f) * (shape.weight.empty() ? 1.0f : kTuning.rotation_arm_mm);
  const float threshold = scale_ * kTuning.still_mm / effect, tolerance = scale_ * tolerance_mm_;
  for (std::size_t level = rasters_.size(); level-- > 0;) {
    FieldGrid grid = cropped(sampled(level, values), threshold);
    const std::vector<float> off = deviations(grid, values);
    if (*std::max_element(off.begin(), off.end()) * effect > tolerance) continue;
    return grid;
  }
  FieldGrid best = cropped(fitted(0, values, threshold), threshold);
  const std::vector<float> finest = deviations(best, values);
  for (std::size_t level = 1; level < rasters_.size(); ++level) {
    FieldGrid grid = cropped(fitted(level, values, threshold), threshold);
    if (largest_excess(deviations(grid, values), finest) * effect > tolerance) break;
    best = std::move(grid);
  }
  return best;
}

template <class T>
FieldGrid ShapeGrids::sampled(std::size_t level, const std::vector<T>& values) const {
  FieldGrid grid = grid_of(rasters_[level], values);
  clear_border(grid, rasters_[level]);
  return grid;
}

template <class T>
FieldGrid ShapeGrids::fitted(std::size_t level, const std::vector<T>& values, float threshold) const {
  FieldGrid grid = grid_of(rasters_[level], values);
  fit_grid(grid, places_, values, threshold);
  clear_border(grid, rasters_[level]);
  return grid;
}

/// Distances between the grid and the values at the vertices of the surface.
std::vector<float> ShapeGrids::deviations(const FieldGrid& grid, const std::vector<Vec3>& values) const {
  std::vector<float> result;
  for (const std::size_t v : surface_) {
    const Vec2 uv = source_.uv[v];
    result.push_back(length(values[v] - Vec3{sample(grid, 0, uv), sample(grid, 1, uv), sample(grid, 2, uv)}));
  }
  return result;
}
std::vector<float> ShapeGrids::deviations(const FieldGrid& grid, const std::vector<float>& values) const {
  std::vector<float> result;
  for (const std::size_t v : surface_)
    result.push_back(std::fabs(values[v] - sample(grid, 0, source_.uv[v])));
  return result;
}

}  // namespace pliant::host::bake
