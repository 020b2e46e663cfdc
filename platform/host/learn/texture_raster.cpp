#include "host/learn/texture_raster.hpp"

#include <algorithm>
#include <cmath>

namespace pliant::host::learn {

TextureRaster::TextureRaster(int width, int height, int samples)
    : samples_(samples),
      columns_(width * samples),
      rows_(height * samples),
      buffer_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {}

void TextureRaster::clear() {
  std::fill(buffer_.begin(), buffer_.end(), Sample{});
  drawn_.clear();
}

void TextureRaster::draw(const std::vector<TextureVertex>& vertices,
                         const std::vector<FaceTriangle>& triangles) {
  for (const FaceTriangle& t : triangles) {
    const Corners corners{{vertices[t.corner[0]], vertices[t.corner[1]], vertices[t.corner[2]]}, t.part};
    if (corners.v[0].inverse_depth > 0 && corners.v[1].inverse_depth > 0 && corners.v[2].inverse_depth > 0)
      draw(corners);
  }
}

void TextureRaster::draw(const Corners& corners) {
  const auto s = static_cast<float>(samples_);
  const auto at = [&](int k) {
    return Vec2{(corners.v[k].x.x + 0.5f) * s - 0.5f, (corners.v[k].x.y + 0.5f) * s - 0.5f};
  };
  const Vec2 p = at(0), q = at(1), r = at(2), pq = q - p, pr = r - p;
  const float area = pq.x * pr.y - pq.y * pr.x;
  if (!(magnitude(area) > 1e-6f)) return;
  const auto first = [](float x, int count) {
    return static_cast<int>(std::ceil(clamp(x, 0, static_cast<float>(count))));
  };
  const auto last = [](float x, int count) {
    return static_cast<int>(std::floor(clamp(x, -1, static_cast<float>(count - 1))));
  };
  const int i0 = first(std::min({p.x, q.x, r.x}), columns_), i1 = last(std::max({p.x, q.x, r.x}), columns_);
  const int j0 = first(std::min({p.y, q.y, r.y}), rows_), j1 = last(std::max({p.y, q.y, r.y}), rows_);
  if (i0 > i1 || j0 > j1) return;
  const float za = corners.v[0].inverse_depth, zb = corners.v[1].inverse_depth,
              zc = corners.v[2].inverse_depth;
  const float scale = 1 / area;
  const auto triangle = static_cast<std::uint32_t>(drawn_.size());
  bool is_visible = false;
  for (int j = j0; j <= j1; ++j)
    for (int i = i0; i <= i1; ++i) {
      const float dx = static_cast<float>(i) - p.x, dy = static_cast<float>(j) - p.y;
      const float b = (dx * pr.y - dy * pr.x) * scale, c = (pq.x * dy - pq.y * dx) * scale, a = 1 - b - c;
      if (a < 0 || b < 0 || c < 0) continue;
      const float z = a * za + b * zb + c * zc;
      Sample& sample = buffer_[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_) +
                               static_cast<std::size_t>(i)];
      if (!(z > sample.inverse_depth)) continue;
      sample = {z, triangle, b * zb / z, c * zc / z};
      is_visible = true;
    }
  if (is_visible) drawn_.push_back(corners);
}

float TextureRaster::depth(Vec2 x) const {
  const auto s = static_cast<float>(samples_);
  const float column = std::floor((x.x + 0.5f) * s), row = std::floor((x.y + 0.5f) * s);
  if (!(column >= 0 && row >= 0 && column < static_cast<float>(columns_) && row < static_cast<float>(rows_)))
    return 0;
  const float z = buffer_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                          static_cast<std::size_t>(column)]
                      .inverse_depth;
  return z > 0 ? 1 / z : 0;
}

bool TextureRaster::fragment(int column, int row, TextureFragment* out) const {
  const Sample& sample = buffer_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                                 static_cast<std::size_t>(column)];
  if (!(sample.inverse_depth > 0)) return false;
  const Corners& corners = drawn_[sample.triangle];
  const float a = 1 - sample.b - sample.c;
  const TextureVertex &p = corners.v[0], &q = corners.v[1], &r = corners.v[2];
  const auto mixed = [&](auto x, auto y, auto z) { return a * x + sample.b * y + sample.c * z; };
  out->texture = mixed(p.texture, q.texture, r.texture);
  out->fixed = mixed(p.fixed, q.fixed, r.fixed);
  out->second = mixed(p.second, q.second, r.second);
  out->light = mixed(p.light, q.light, r.light);
  out->cover = mixed(p.cover, q.cover, r.cover);
  out->second_weight = mixed(p.second_weight, q.second_weight, r.second_weight);
  out->part = corners.part;
  return true;
}

}  // namespace pliant::host::learn
