#pragma once
// The gradient cells of a vertical strip of a reduced frame, row by row, as many rows as the detector's window has.
#include <cstdint>

#include "face/detector_table.hpp"
#include "face/scaled_lines.hpp"
#include "pliant/arena.hpp"

namespace pliant {

/// Cells of a strip. A cell's place is counted from the upper left corner of the reduced frame, and may lie beyond its
/// border. Cells do not depend on the strip that they are computed in.
class CellStrip {
 public:
  /// \param columns  the most columns of a strip, at least kWindowCells. Bytes: 310 a column.
  void lay_out(Arena& arena, int columns);

  /// Begins a strip: the next row is `row`.
  /// \pre columns <= columns of the layout.
  void begin(int column, int columns, int row);
  /// Computes the next row. All rows of a strip must come from frames of one size and one ratio.
  void add_row(const ScaledLines& lines);
  /// Rows since `begin` of which all neighbours are known: those that windows can be made of.
  int rows() const { return rows_; }
  /// The row behind the last one.
  int next_row() const { return first_row_ + rows_; }

  /// The upper left cell of the window of the last kWindowCells rows whose first column is `k`, counted in the strip.
  /// \pre rows() >= kWindowCells, k + kWindowCells <= columns.
  const std::uint8_t* window(int k) const {
    return cells_ + (rows_ % kWindowCells) * stride_ + k * kCellChannels;
  }
  int stride() const { return stride_; }  ///< Bytes from one row of cells to the next.

 private:
  static constexpr int kAround = 2 * kDetectorReach + 1;  // rows of sums that a row is normalised with
  static constexpr int kLines = kDetectorCellPx + 2;      // lines that a row of sums reads
  int apron_columns() const { return columns_ + 2 * kDetectorReach; }
  int line_px() const { return apron_columns() * kDetectorCellPx + 2; }
  void add_sums(const ScaledLines& lines);

  int columns_ = 0, column_ = 0, first_row_ = 0, rows_ = 0, sum_rows_ = 0, stride_ = 0;
  std::uint32_t* scratch_ = nullptr;
  std::uint8_t* lines_ = nullptr;       // kLines lines
  CellSums* sums_ = nullptr;            // kAround rows, in turn
  std::uint8_t* normalised_ = nullptr;  // one row with the apron
  // kWindowCells rows in turn, then the same again, so that a window is contiguous.
  std::uint8_t* cells_ = nullptr;
};

}  // namespace pliant
