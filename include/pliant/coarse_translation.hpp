#pragma once
/// \file coarse_translation.hpp
/// Where a whole region of a small picture has gone: the first guess of a fast motion, and the way back after a loss.
#include "pliant/geometry.hpp"
#include "pliant/pyramid.hpp"
#include "pliant/status.hpp"

namespace pliant {

/// A rectangle of pixels, [x0, x1) x [y0, y1).
struct PixelBox {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

struct CoarseTranslation {
  Vec2 by;                ///< px of the pictures compared; sub-pixel by a parabola through the best
  float correlation = 0;  ///< normalised, -1 to 1; 0 when nothing could be compared
};

/// Finds the shift of `box` from `reference` to `current` that correlates best, within `range_px` each way. Only pixels that
/// both pictures have take part, and a shift where fewer than half do is not considered. Pixels are taken at a
/// spacing that leaves at most about 600 of them. Ties: the smaller shift. Sums are integers: the same bits everywhere.
/// Cost: (2 range_px + 1)^2 x 600 multiply-adds. Pictures of different sizes or unreadable ones give no shift.
CoarseTranslation find_coarse_translation(const ImageView& reference, const PixelBox& box, const ImageView& current, int range_px);

}  // namespace pliant
