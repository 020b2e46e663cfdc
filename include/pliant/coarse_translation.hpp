#pragma once
/// \file coarse_translation.hpp
/// The image shift between two thumbnails: a first estimate of a fast motion, and of the position after a loss.
#include <cstdint>

#include "pliant/geometry.hpp"
#include "pliant/pyramid.hpp"
#include "pliant/status.hpp"

namespace pliant {

/// A rectangle of pixels, [x0, x1) x [y0, y1).
struct PixelBox {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  ///< px; x1 and y1 are outside
};

/// Shift between two images.
struct CoarseTranslation {
  Vec2 by;                            ///< px of the images compared; sub-pixel by a parabola through the best
  float correlation = 0;              ///< normalised cross-correlation, -1 to 1; 0 if nothing was compared
  std::uint32_t compared_pixels = 0;  ///< of all shifts together
};

/// Finds the shift of `box` from `reference` to `current` with the highest correlation (docs/algorithms.md, section 7.9).
/// Every third shift within `range_px` is tried in x and in y, and then all shifts within two pixels of the best.
///
/// The box is clipped to the image. Of large boxes rows are left out, so that about 1,200 pixels are compared, but at least
/// one row. A shift for which fewer than half of them lie in `current`, or an image is flat, counts as correlation 0. Of
/// shifts with equal correlation the smaller is taken. Sums are integers: the bits are the same on every target.
/// \param range_px  largest shift along x and along y, px of the images compared, at least 0.
/// \param expected  many shifts of a pattern that repeats are equally good. Of those the peak near this shift, px, is taken, up to
///                  which the correlation rises from there. Finite. Null: nothing is known.
/// \return the best shift, which means nothing without a correlation above 0; no shift and correlation 0 for images of
///         different sizes or with a side above 16,384 px, unreadable views, a box of fewer than 4 x 4 px, or a
///         negative range.
/// Cost: at most ((2 range_px / 3 + 1)^2 + 62) * 3 max(1200, width of the box) multiply-adds, without an expected shift 30
/// instead of 62; range_px counts as at most the larger side.
CoarseTranslation find_coarse_translation(const ImageView& reference, const PixelBox& box,
                                          const ImageView& current, int range_px,
                                          const Vec2* expected = nullptr);

}  // namespace pliant
