#pragma once
/// \file surface_sheet.hpp
/// A model's whole chart as a dense grid of surface points, for rendering. Of a model with lids or lips the holes of the mask
/// (eyes, mouth) are included, as the fields are defined there too.
#include <vector>

#include "host/io/owned.hpp"
#include "pliant/cascade.hpp"

namespace pliant::host {

/// The albedo of the surface, and the part of the chart that it covers.
class ChartTexture {
 public:
  explicit ChartTexture(const Model& model);
  /// Bilinear, in [0,255]; a model without albedo is light grey.
  float albedo(Vec2 uv) const;
  /// True where the domain mask is surface; of a model with lids or lips its holes count as surface.
  bool covers(Vec2 uv) const;
  /// From 0 (outside) to 1 (inside); 1/2 on the boundary.
  float cover(Vec2 uv) const;

 private:
  ChartImage albedo_;
  std::uint32_t mask_width_ = 0, mask_height_ = 0;
  std::vector<std::uint8_t> cover_;  // 255 inside, 0 outside
};

/// A grid of (cells + 1)^2 points over the chart. New expressions cost one evaluation of the cascade a point. A new identity
/// also samples the fields again.
class SurfaceSheet {
 public:
  SurfaceSheet(const Model& model, const ChartTexture& texture, int cells);

  /// Computes positions and smooth normals for these parameters.
  void set(const float* q);

  int cells() const { return cells_; }
  std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(cells_ + 1) + static_cast<std::size_t>(i);
  }
  /// Calls `triangle(a, b, c)` with point indices for both halves of each cell.
  template <class Triangle>
  void for_each_triangle(const Triangle& triangle) const {
    for (int j = 0; j < cells_; ++j)
      for (int i = 0; i < cells_; ++i) {
        triangle(index(i, j), index(i + 1, j), index(i, j + 1));
        triangle(index(i + 1, j), index(i + 1, j + 1), index(i, j + 1));
      }
  }
  /// False if the point and its neighbours lie outside the boundary; such a point is not evaluated.
  bool is_used(std::size_t k) const { return used_[k] != 0; }
  Vec2 uv(std::size_t k) const { return uv_[k]; }
  /// Model millimetres.
  Vec3 position(std::size_t k) const { return position_[k]; }
  /// Outward unit normal.
  Vec3 normal(std::size_t k) const { return normal_[k]; }

 private:
  void sample_points(const float* q);
  void compute_normals();

  Owned<Cascade> cascade_;
  int cells_;
  std::vector<std::uint8_t> used_;
  std::vector<Vec2> uv_;
  std::vector<Vec3> position_, normal_, samples_;
  std::vector<float> sampled_for_;  // the identity with which samples_ were taken
  bool is_sampled_ = false;
};

}  // namespace pliant::host
