#pragma once
/// \file polygon.hpp
/// Whether a point lies inside a polygon.
#include <vector>

namespace pliant::host {

/// Whether the ray from x along the first axis crosses the edge from a to b. A point is inside of what it crosses an odd number of
/// edges of, of one loop or of several.
template <class Point>
bool crosses_edge(const Point& x, const Point& a, const Point& b) {
  return (a.y > x.y) != (b.y > x.y) && x.x < a.x + (x.y - a.y) * (b.x - a.x) / (b.y - a.y);
}

/// True if x lies inside a polygon, by the parity of crossings.
template <class Point>
bool is_inside(const std::vector<Point>& polygon, const Point& x) {
  bool inside = false;
  for (std::size_t k = 0; k < polygon.size(); ++k)
    inside ^= crosses_edge(x, polygon[k], polygon[(k + 1) % polygon.size()]);
  return inside;
}

}  // namespace pliant::host
