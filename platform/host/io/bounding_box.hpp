#pragma once
/// \file bounding_box.hpp
/// The smallest box around points.
#include <vector>

#include "pliant/geometry.hpp"

namespace pliant::host {

/// \tparam Vector  Vec2 or Vec3.
template <class Vector>
struct BoundingBox {
  Vector low{}, high{};  ///< corners; zero without points
  bool is_empty = true;

  BoundingBox() = default;
  explicit BoundingBox(const std::vector<Vector>& points) {
    for (const Vector p : points) add(p);
  }
  void add(Vector p) {
    low = is_empty ? p : min(low, p);
    high = is_empty ? p : max(high, p);
    is_empty = false;
  }
  Vector size() const { return high - low; }
};

}  // namespace pliant::host
