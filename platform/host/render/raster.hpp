#pragma once
/// \file raster.hpp
/// A software rasteriser: perspective-correct triangles, a depth buffer and supersampling. Without the host library, so that tests
/// draw with it on every target.
#include <algorithm>
#include <cstddef>
#include <vector>

#include "pliant/geometry.hpp"

namespace pliant::host {

/// A corner of a triangle: its image position, 1 / depth (any unit, > 0), and the values that are interpolated.
struct RasterVertex {
  Vec2 x;  ///< image px, pixel centres at integers
  float inverse_depth = 0;
  Vec2 uv;
  float light = 0;
};

/// Whether the corners run clockwise in the picture, as those of SurfaceSheet::for_each_triangle do where its outer side is seen.
inline bool is_clockwise(const RasterVertex& a, const RasterVertex& b, const RasterVertex& c) {
  const Vec2 d = b.x - a.x, e = c.x - a.x;
  return d.x * e.y - d.y * e.x > 0;
}

/// A grey picture of `width` x `height` pixels with `samples` x `samples` samples each.
class Raster {
 public:
  Raster(int width, int height, int samples)
      : width_(width),
        height_(height),
        samples_(samples),
        inverse_depth_(index(0, height * samples)),
        grey_(inverse_depth_.size()) {}

  int width() const { return width_; }
  int height() const { return height_; }
  /// Removes everything that was drawn.
  void clear() { std::fill(inverse_depth_.begin(), inverse_depth_.end(), 0.0f); }

  /// Draws a triangle of either winding. At each sample that it covers, and where nothing nearer was drawn, it calls
  /// `shade(uv, light, &grey)`, which returns whether there is surface and sets its brightness.
  template <class Shade>
  void draw(const RasterVertex& a, const RasterVertex& b, const RasterVertex& c, const Shade& shade);

  /// Mean grey value of a pixel, uncovered samples taken from `background`.
  float value(int x, int y, float background) const;
  /// 1 / depth at a pixel's first sample; 0 where nothing was drawn.
  float inverse_depth(int x, int y) const { return inverse_depth_[index(x * samples_, y * samples_)]; }
  /// Fraction of the pixel's samples that are covered.
  float coverage(int x, int y) const;

 private:
  Vec2 to_samples(Vec2 x) const {
    const auto s = static_cast<float>(samples_);
    return {(x.x + 0.5f) * s - 0.5f, (x.y + 0.5f) * s - 0.5f};
  }
  std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(width_ * samples_) +
           static_cast<std::size_t>(i);
  }

  int width_, height_, samples_;
  std::vector<float> inverse_depth_;  // 0: not covered
  std::vector<float> grey_;
};

inline float Raster::value(int x, int y, float background) const {
  float sum = 0;
  for (int j = y * samples_; j < (y + 1) * samples_; ++j)
    for (int i = x * samples_; i < (x + 1) * samples_; ++i)
      sum += inverse_depth_[index(i, j)] > 0 ? grey_[index(i, j)] : background;
  return sum / static_cast<float>(samples_ * samples_);
}

inline float Raster::coverage(int x, int y) const {
  int covered = 0;
  for (int j = y * samples_; j < (y + 1) * samples_; ++j)
    for (int i = x * samples_; i < (x + 1) * samples_; ++i)
      covered += inverse_depth_[index(i, j)] > 0 ? 1 : 0;
  return static_cast<float>(covered) / static_cast<float>(samples_ * samples_);
}

template <class Shade>
void Raster::draw(const RasterVertex& a, const RasterVertex& b, const RasterVertex& c, const Shade& shade) {
  const Vec2 p = to_samples(a.x), q = to_samples(b.x), r = to_samples(c.x);
  const auto cross = [](Vec2 d, Vec2 e) { return d.x * e.y - d.y * e.x; };
  const float area = cross(q - p, r - p);
  if (!(magnitude(area) > 1e-12f)) return;
  const float side = area < 0 ? -1.0f : 1.0f;
  const auto columns = static_cast<float>(width_ * samples_ - 1),
             rows = static_cast<float>(height_ * samples_ - 1);
  // Without SSE4.1 std::ceil is a call.
  const auto up = [](float t) { return static_cast<int>(t) + (static_cast<float>(static_cast<int>(t)) < t); };
  const auto down = [](float t) {
    return static_cast<int>(t) - (static_cast<float>(static_cast<int>(t)) > t);
  };
  const int i0 = up(clamp(min(p.x, min(q.x, r.x)), 0, columns + 1)),
            i1 = down(clamp(max(p.x, max(q.x, r.x)), -1, columns)),
            j0 = up(clamp(min(p.y, min(q.y, r.y)), 0, rows + 1)),
            j1 = down(clamp(max(p.y, max(q.y, r.y)), -1, rows));
  for (int j = j0; j <= j1; ++j)
    for (int i = i0; i <= i1; ++i) {
      const Vec2 s{static_cast<float>(i), static_cast<float>(j)};
      // Barycentric in the image; dividing by depth makes them barycentric on the surface.
      const float of_a = cross(q - s, r - s), of_b = cross(r - s, p - s);
      if (side * of_a < 0 || side * of_b < 0) continue;  // most of them, without a division
      const float wa = of_a / area, wb = of_b / area, wc = 1 - wa - wb;
      if (wc < 0) continue;
      const float za = wa * a.inverse_depth, zb = wb * b.inverse_depth, zc = wc * c.inverse_depth,
                  z = za + zb + zc;
      if (!(z > inverse_depth_[index(i, j)])) continue;
      const float depth = 1 / z;
      const Vec2 uv = depth * (za * a.uv + zb * b.uv + zc * c.uv);
      float grey = 0;
      if (!shade(uv, depth * (za * a.light + zb * b.light + zc * c.light), &grey)) continue;
      inverse_depth_[index(i, j)] = z;
      grey_[index(i, j)] = grey;
    }
}

}  // namespace pliant::host
