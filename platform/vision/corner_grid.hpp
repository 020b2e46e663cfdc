#pragma once
// The best corner of each cell of an image. It is scanned once; then corners can be chosen from it at several
// distances.
#include <cstdint>

#include "pliant/corners.hpp"

namespace pliant::corners {

/// The best corner of one cell; score 0: there is none.
struct Cell {
  float score;
  std::uint16_t x, y;
};

/// All cells of an image, in the memory of a scratch arena.
struct Grid {
  int cell_px, width, height;  // cells
  Cell* cells;
  std::int32_t* order;     // cells that have a corner, a heap
  std::uint8_t* is_taken;  // 1: the cell's corner was chosen
  float* rows[3];          // scores of three rows of pixels, and a zero at either end
  float* peaks;            // of one row

  int count() const { return width * height; }
  Cell& at(int x, int y) const { return cells[(y / cell_px) * width + x / cell_px]; }
};

/// Finds the best corner of each allowed cell. \param grid  its memory is of `scratch`. \return as find_corners.
Status scan_cells(const ImageView& image, const CornerOptions& options, Span<const std::uint8_t> allowed,
                  Arena& scratch, Grid* grid);
/// Chooses as find_corners. \return how many.
int choose_corners(const Grid& grid, float quality, float min_distance_px, Span<Corner> out);

}  // namespace pliant::corners
