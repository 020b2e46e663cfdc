#include "host/learn/painting.hpp"

#include "host/io/polygon.hpp"

namespace pliant::host::learn {

float outside_capsule(Vec2 x, Vec2 a, Vec2 b, float radius) {
  const Vec2 ab = b - a, ax = x - a;
  const float t = clamp(dot(ax, ab) / max(dot(ab, ab), 1e-6f), 0, 1);
  return length(ax - t * ab) - radius;
}

float outside_polygon(Vec2 x, const std::vector<Vec2>& polygon) {
  float nearest = 1e9f;
  bool is_inside = false;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec2 a = polygon[k], b = polygon[(k + 1) % polygon.size()];
    nearest = min(nearest, outside_capsule(x, a, b, 0));
    is_inside ^= crosses_edge(x, a, b);
  }
  return is_inside ? -nearest : nearest;
}

float outside_ellipse(Vec2 x, Vec2 middle, Vec2 radii) {
  const Vec2 d{(x.x - middle.x) / radii.x, (x.y - middle.y) / radii.y};
  return (length(d) - 1) * min(radii.x, radii.y);
}

}  // namespace pliant::host::learn
