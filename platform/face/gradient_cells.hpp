#pragma once
// Gradient cells: a picture as histograms of gradient directions over square cells, relative to the mean
// gradient around each cell. The gain and bias of the light do not change them. Integers only
// (docs/algorithms.md, section 7.11).
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/pyramid.hpp"

namespace pliant {

/// Sums over the pixels of one cell, before normalisation.
struct CellSums {
  /// Gradient by direction, multiples of 45 degrees from +x towards +y (down). A gradient counts to its two neighbours.
  std::uint16_t direction[8];
  std::uint16_t total;       ///< of the eight
  std::uint16_t brightness;  ///< grey levels
};

/// Bytes that describe one cell: eight directions, then brightness.
/// Direction: direction_gain * (mean gradient of the cell in this direction) / (mean gradient of the
/// neighbourhood + noise), at most 255. Brightness: 128 + brightness_gain * (mean of the cell - mean of the
/// neighbourhood) / (the same), 0 to 255.
constexpr int kCellChannels = 9;
constexpr int kLargestCellPx = 8;  ///< pixels a cell's side

/// Sums of one row of `columns` cells of `cell_px` x `cell_px` pixels (1 to kLargestCellPx). The first cell's
/// upper left pixel is `first`, the next row is `stride` bytes further. Central differences read one pixel
/// beyond the cells on each side. Cost: about 25 operations a pixel.
void sum_cells(const std::uint8_t* first, int stride, int columns, int cell_px, CellSums* out);

/// Rows of sums around the row to be normalised, from above to below; the middle one is rows[count / 2]. A
/// row that lies beyond the picture is null.
struct CellRows {
  const CellSums* const* rows;
  int count;  ///< odd: 1, 3 or 5
};

/// Normalises one row of cells: writes kCellChannels bytes a cell. The neighbourhood is a square of
/// `around.count` cells, cut at the row's ends. Cost: about 60 operations a cell.
void normalise_cells(const CellRows& around, int columns, int cell_px, std::uint8_t* out);

/// Gradient cells of whole small pictures, such as an aligner's crop.
class GradientCells {
 public:
  /// \param cells  the most cells of a picture. Bytes: 20 a cell.
  void lay_out(Arena& arena, int cells);

  /// Writes columns x rows x kCellChannels bytes, rows without padding. Cell (i, j) covers the pixels from
  /// (1 + i cell_px, 1 + j cell_px) on: the picture has a border of one pixel, which only gradients read.
  /// Preconditions: columns * rows <= cells of the layout; the picture has at least columns * cell_px + 2 by
  /// rows * cell_px + 2 pixels; reach is 0, 1 or 2 cells to each side of a cell.
  void compute(const ImageView& image, int columns, int rows, int cell_px, int reach, std::uint8_t* out);

 private:
  int capacity_ = 0;
  CellSums* sums_ = nullptr;
};

}  // namespace pliant
