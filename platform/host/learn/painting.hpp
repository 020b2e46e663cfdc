#pragma once
/// \file painting.hpp
/// Shapes with soft edges, blended into grey pictures.
#include <initializer_list>
#include <vector>

#include "host/io/image.hpp"
#include "pliant/geometry.hpp"

namespace pliant::host::learn {

/// Distance to a segment with round ends, px; negative inside.
float outside_capsule(Vec2 x, Vec2 a, Vec2 b, float radius);
/// Signed distance to a polygon, px; negative inside.
float outside_polygon(Vec2 x, const std::vector<Vec2>& polygon);
/// About the distance to an ellipse with upright axes, px; negative inside.
float outside_ellipse(Vec2 x, Vec2 middle, Vec2 radii);

/// A box around points, px.
struct PaintBounds {
  Vec2 low{1e9f, 1e9f}, high{-1e9f, -1e9f};
  PaintBounds(std::initializer_list<Vec2> points, float reach) { take(points, reach); }
  PaintBounds(const std::vector<Vec2>& points, float reach) { take(points, reach); }

 private:
  template <class Points>
  void take(const Points& points, float reach) {
    for (const Vec2 p : points) {
      low = min(low, p - Vec2{reach, reach});
      high = max(high, p + Vec2{reach, reach});
    }
  }
};

/// Blends `grey(x)` in where `outside(x)` is negative, which is within `bounds`.
/// \param softness  width of the edge, px.
template <class Outside, class Grey>
void paint(Image& picture, const PaintBounds& bounds, const Outside& outside, const Grey& grey, float opacity,
           float softness) {
  const auto limit = [](float x, int size) {
    return static_cast<int>(clamp(x, 0, static_cast<float>(size)));
  };
  const int x1 = limit(bounds.high.x + softness + 1, picture.width),
            y1 = limit(bounds.high.y + softness + 1, picture.height);
  for (int y = limit(bounds.low.y - softness, picture.height); y < y1; ++y)
    for (int x = limit(bounds.low.x - softness, picture.width); x < x1; ++x) {
      const Vec2 at{static_cast<float>(x), static_cast<float>(y)};
      const float cover = clamp(0.5f - outside(at) / softness, 0, 1) * opacity;
      if (!(cover > 0)) continue;
      const float old = static_cast<float>(*picture.at(x, y));
      *picture.at(x, y) = static_cast<std::uint8_t>(clamp(old + cover * (grey(at) - old) + 0.5f, 0, 255));
    }
}

}  // namespace pliant::host::learn
