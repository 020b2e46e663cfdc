#include "face/cell_strip.hpp"

namespace pliant {

void CellStrip::lay_out(Arena& arena, int columns) {
  PLIANT_ASSERT(columns >= kWindowCells);
  columns_ = columns;
  const std::size_t line = static_cast<std::size_t>(line_px()),
                    sums = static_cast<std::size_t>(apron_columns());
  scratch_ = arena.take<std::uint32_t>(line);
  lines_ = arena.take<std::uint8_t>(kLines * line);
  sums_ = arena.take<CellSums>(kAround * sums);
  normalised_ = arena.take<std::uint8_t>(kCellChannels * sums);
  cells_ = arena.take<std::uint8_t>(2 * kWindowCells * kCellChannels * static_cast<std::size_t>(columns));
}

void CellStrip::begin(int column, int columns, int row) {
  column_ = column;
  columns_ = columns;
  stride_ = columns * kCellChannels;
  first_row_ = row;
  rows_ = 0;
  sum_rows_ = 0;
}

// The next row of sums; the first one is kDetectorReach rows above the strip.
void CellStrip::add_sums(const ScaledLines& lines) {
  const int x = (column_ - kDetectorReach) * kDetectorCellPx - 1;
  const int y = (first_row_ - kDetectorReach + sum_rows_) * kDetectorCellPx - 1, count = line_px();
  const int kept = sum_rows_ > 0 ? 2 : 0;  // lines that the row before has read
  for (int k = 0; k < kept * count; ++k) lines_[k] = lines_[kDetectorCellPx * count + k];
  for (int j = kept; j < kLines; ++j) lines.read(x, y + j, count, scratch_, lines_ + j * count);
  sum_cells(lines_ + count + 1, count, apron_columns(), kDetectorCellPx,
            sums_ + (sum_rows_ % kAround) * apron_columns());
  ++sum_rows_;
}

void CellStrip::add_row(const ScaledLines& lines) {
  do add_sums(lines);
  while (sum_rows_ < kAround);
  const CellSums* around[kAround];
  for (int k = 0; k < kAround; ++k) around[k] = sums_ + ((sum_rows_ + k) % kAround) * apron_columns();
  normalise_cells({around, kAround}, apron_columns(), kDetectorCellPx, normalised_);
  std::uint8_t* const row = cells_ + (rows_ % kWindowCells) * stride_;
  const std::uint8_t* const inner = normalised_ + kDetectorReach * kCellChannels;
  for (int k = 0; k < stride_; ++k) row[k] = row[k + kWindowCells * stride_] = inner[k];
  ++rows_;
}

}  // namespace pliant
