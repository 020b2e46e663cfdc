#pragma once
/// \file surface_sheet.hpp
/// A model's whole chart as a dense grid of surface points, for drawing: holes of the mask (eyes, mouth)
/// included, as the fields are defined there too.
#include <vector>

#include "host/io/owned.hpp"
#include "pliant/cascade.hpp"

namespace pliant::host {

/// What is painted on the surface: its albedo, and where there is surface at all.
class ChartTexture {
 public:
  explicit ChartTexture(const Model& model);
  /// Bilinear, in [0,255]; a model without albedo is light grey.
  float albedo(Vec2 uv) const;
  /// True inside the outer outline of the domain mask; its inner holes count as inside.
  bool covers(Vec2 uv) const { return cover(uv) >= 0.5f; }
  /// From 0 (outside) to 1 (inside), 1/2 on the outline.
  float cover(Vec2 uv) const;

 private:
  ChartImage albedo_;
  std::uint32_t mask_width_ = 0, mask_height_ = 0;
  std::vector<std::uint8_t> cover_;  // 255 inside, 0 outside
};

/// A grid of (cells + 1)^2 points over the chart. Moving the expression costs one cascade evaluation a point;
/// moving the identity samples the fields again.
class SurfaceSheet {
 public:
  SurfaceSheet(const Model& model, const ChartTexture& texture, int cells);

  /// Takes on the parameters: positions and smooth normals.
  void set(const float* q);

  int cells() const { return cells_; }
  std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(cells_ + 1) + static_cast<std::size_t>(i);
  }
  /// Calls `triangle(a, b, c)` with the point numbers of both halves of each cell.
  template <class Triangle>
  void for_each_triangle(const Triangle& triangle) const {
    for (int j = 0; j < cells_; ++j)
      for (int i = 0; i < cells_; ++i) {
        triangle(index(i, j), index(i + 1, j), index(i, j + 1));
        triangle(index(i + 1, j), index(i + 1, j + 1), index(i, j + 1));
      }
  }
  /// False where the point and its neighbours lie beyond the outline: not evaluated, not to be drawn.
  bool is_used(std::size_t k) const { return used_[k] != 0; }
  Vec2 uv(std::size_t k) const { return uv_[k]; }
  /// Model millimetres.
  Vec3 position(std::size_t k) const { return position_[k]; }
  /// Unit length, outwards: seen from there, v points down where u points right (model.hpp).
  Vec3 normal(std::size_t k) const { return normal_[k]; }

 private:
  void bake(const float* q);
  void compute_normals();

  Owned<Cascade> cascade_;
  int cells_;
  std::vector<std::uint8_t> used_;
  std::vector<Vec2> uv_;
  std::vector<Vec3> position_, normal_, baked_;
  std::vector<float> baked_for_;  // the identity that is folded into baked_
  bool is_baked_ = false;
};

}  // namespace pliant::host
