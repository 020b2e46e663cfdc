#pragma once
/// \file corners.hpp
/// Where a picture has texture in two directions: the points worth tracking (Shi and Tomasi, 1994).
///
/// The measure is the smaller eigenvalue of the mean structure tensor over 7 x 7 pixels, in (grey/px)^2, of
/// Scharr's gradients (3 10 3, divided by 32). Sums are integers; the bits are the same on every target.
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/geometry.hpp"
#include "pliant/pyramid.hpp"
#include "pliant/status.hpp"

namespace pliant {

/// Texture around one point.
struct CornerScore {
  float lambda_min = 0;  ///< eigenvalues of the mean structure tensor, (grey/px)^2; 0 when unknown
  float lambda_max = 0;
  Vec2 direction;  ///< unit, of the strongest gradient (eigenvector of lambda_max), x >= 0; zero where flat
};

/// Pixels between a scored point and the border of the picture, at least.
constexpr int kCornerMargin = 4;

/// Texture around the pixel nearest to x. All zero for an unreadable view, a NaN, or a point nearer to the
/// border than kCornerMargin. Cost: 49 gradients.
CornerScore corner_score(const ImageView& image, Vec2 x);

struct Corner {
  Vec2 x;           ///< whole pixels
  float score = 0;  ///< lambda_min, (grey/px)^2
};

struct CornerOptions {
  int cell_px = 8;            ///< at most one corner in each square cell of this side; 2 to 128
  float min_score = 4;        ///< lambda_min at least this, (grey/px)^2
  float quality = 0.01f;      ///< and at least this share of the best in the picture; 0 to 1
  float min_ratio = 0.05f;    ///< lambda_min / lambda_max at least this, so that edges are no corners
  float min_distance_px = 8;  ///< between any two corners; 0 to 256
};

/// Number of cells that cover `pixels`.
constexpr int corner_cells(int pixels, int cell_px) {
  return (pixels + cell_px - 1) / cell_px;
}

/// Bytes that `find_corners` takes from its scratch arena for a picture of this size, and gives back.
std::size_t corner_scratch_bytes(int width, int height, const CornerOptions& options);

/// The best corners: local maxima of lambda_min over 3 x 3 pixels, the best of each cell, taken from the best
/// downwards where no better one is within min_distance_px. Equal scores: lower y first, then lower x.
/// \param allowed  empty, or one byte a cell, row by row (corner_cells wide and high): 0 forbids the cell.
/// \param out      room for the corners; `count` says how many there are.
/// \return bad_argument for an unreadable view, options out of range or a mask of another size; out_of_memory
///         when `scratch` is too small; then `count` is as it was. A picture too small for a point gives none.
/// Cost: about 60 operations a pixel of the box around the allowed cells.
Status find_corners(const ImageView& image, const CornerOptions& options, Span<const std::uint8_t> allowed,
                    Arena& scratch, Span<Corner> out, int& count);

}  // namespace pliant
