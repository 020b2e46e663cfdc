#pragma once
/// \file corners.hpp
/// Corners: points of an image with texture in two directions, which can be tracked (Shi and Tomasi 1994;
/// docs/algorithms.md, section 7.1).
///
/// The measure is the smaller eigenvalue of the mean structure tensor over 7 x 7 pixels, in (grey/px)^2, of
/// Scharr gradients (3 10 3, divided by 32). Sums are integers; the bits are the same on every target.
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/geometry.hpp"
#include "pliant/pyramid.hpp"
#include "pliant/status.hpp"

namespace pliant {

/// Smallest distance of a scored point from the border of the image, px.
constexpr int kCornerMargin = 4;

/// The measure of the pixel nearest to x, (grey/px)^2. 0 for an unreadable view, a NaN, or a point closer to the border
/// than kCornerMargin. Cost: 49 gradients.
float corner_score(const ImageView& image, Vec2 x);

/// One corner of an image.
struct Corner {
  Vec2 x;           ///< whole pixels
  float score = 0;  ///< lambda_min, (grey/px)^2
};

/// Which corners are chosen (docs/algorithms.md, section 7.1). The defaults are round values, not tuned.
struct CornerOptions {
  int cell_px = 8;        ///< side of a square cell with at most one corner, 2 to 128
  float min_score = 4;    ///< smallest lambda_min, (grey/px)^2
  float quality = 0.01f;  ///< smallest lambda_min as a fraction of the best in the image, 0 to 1
  /// Smallest lambda_min / lambda_max, 0 to 1, so that edges are not taken for corners.
  float min_ratio = 0.05f;
  float min_distance_px = 8;  ///< between any two corners, 0 to 256
};

/// Number of cells that cover `pixels`.
constexpr int corner_cells(int pixels, int cell_px) {
  return (pixels + cell_px - 1) / cell_px;
}

/// Bytes that `find_corners` takes from its scratch arena for an image of this size and gives back. 0 for a bad
/// argument.
std::size_t corner_scratch_bytes(int width, int height, const CornerOptions& options);

/// Finds the best corners: of the local maxima of lambda_min over 3 x 3 pixels the best of each cell, best first,
/// without those that are closer than min_distance_px to a better one. Of equal scores, lower y comes first, then
/// lower x. What lies outside the box around the allowed cells counts as 0: on its border a maximum need not be one of
/// the image.
/// \param allowed  empty, or one byte a cell, row by row (corner_cells wide and high): 0 forbids the cell.
/// \param out      room for the corners. \param count  set to their number; 0 for an image that is too small.
/// \return `bad_argument` for an unreadable view, options out of range or a mask of another size; `out_of_memory` if
///         `scratch` is too small; then `count` is as it was.
/// Cost: about 60 operations a pixel of the box around the allowed cells.
Status find_corners(const ImageView& image, const CornerOptions& options, Span<const std::uint8_t> allowed,
                    Arena& scratch, Span<Corner> out, int& count);

}  // namespace pliant
