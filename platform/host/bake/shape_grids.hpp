#pragma once
/// \file shape_grids.hpp
/// Chooses the grids that hold a source's shapes.
#include <vector>

#include "host/bake/chart_raster.hpp"
#include "host/bake/field_grid.hpp"
#include "host/bake/grid_fit.hpp"
#include "host/bake/source.hpp"

namespace pliant::host::bake {

class ShapeGrids {
 public:
  /// \param source        must outlive the object
  /// \param surface       its vertices on the surface (reconstruction.hpp); at least one
  /// \param size          samples on a side of the finest grid
  /// \param tolerance_mm  error at the vertices, for a surface of the size that BakeOptions says
  ShapeGrids(const Source& source, const std::vector<std::size_t>& surface, int size, float tolerance_mm);

  /// The rest shape, with twice the samples on a side.
  FieldGrid rest_shape() const;
  /// The coarsest grid within the tolerance. If no sampled grid is within it, the finest grid fitted by least squares, or the
  /// coarsest fitted grid that is as good to within the tolerance.
  FieldGrid shape(const SourceShape& shape) const;
  /// 1 where the surface is, with twice the samples on a side.
  GreyImage mask() const;
  /// Of the surface's box, millimetres.
  float diagonal() const { return diagonal_; }

 private:
  ChartRaster raster(int side) const;
  float most_of(std::size_t parameter) const;
  template <class T>
  FieldGrid grid_for(const std::vector<T>& values, const SourceShape& shape) const;
  template <class T>
  FieldGrid sampled(std::size_t level, const std::vector<T>& values) const;
  template <class T>
  FieldGrid fitted(std::size_t level, const std::vector<T>& values, float threshold) const;
  std::vector<float> deviations(const FieldGrid& grid, const std::vector<Vec3>& values) const;
  std::vector<float> deviations(const FieldGrid& grid, const std::vector<float>& values) const;

  const Source& source_;
  const std::vector<std::size_t> surface_;
  const int size_;
  const float tolerance_mm_;
  std::vector<ChartRaster> rasters_;  // from fine to coarse
  std::vector<FitPlace> places_;
  float diagonal_ = 0, scale_ = 1;  // of lengths
};

}  // namespace pliant::host::bake
