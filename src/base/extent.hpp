// Bounding boxes in the image.
#pragma once
#include "pliant/geometry.hpp"

namespace pliant {

/// The box around points; without points low is far above high.
struct Extent {
  Vec2 low{1e30f, 1e30f}, high{-1e30f, -1e30f};

  void include(Vec2 x) {
    low = min(low, x);
    high = max(high, x);
  }
};

}  // namespace pliant
