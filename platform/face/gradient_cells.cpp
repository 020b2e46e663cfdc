#include "face/gradient_cells.hpp"

#include "base/integers.hpp"
#include "face/gradient_parts.hpp"

namespace pliant {

namespace {

/// Tuning of gradient cells. Each constant: unit, reason, experiment.
struct GradientCellTuning {
  /// Added to the mean gradient, grey levels in two pixels: flat places with noise of about one grey level stay near zero. With
  /// 4, faces in the dark are lost (trained and measured on varied samples of held-out people).
  int noise = 2;
  /// A cell with one direction as strong as the whole neighbourhood's mean gets this value. A single edge among flat cells
  /// reaches about twice the mean, that is 255. Not tuned.
  int direction_gain = 128;
  /// Of brightness, against the mean gradient. Not tuned.
  int brightness_gain = 24;
};
constexpr GradientCellTuning kTuning{};

// Gradients of a cell by octant: bit 0 is dx < 0, bit 1 dy < 0, bit 2 |dy| > |dx|. The part along the diagonal is in the lower
// half of a word, the part along the axis in the upper half.
struct OctantSums {
  std::uint32_t octant[8];
  unsigned brightness;

  unsigned axis(int k) const { return octant[k] >> 16; }
  unsigned diagonal(int k) const { return octant[k] & 0xffff; }
};

void add_line(const std::uint8_t* line, int stride, int pixels, OctantSums* sums) {
  const std::uint8_t *above = line - stride, *below = line + stride;
  for (int x = 0; x < pixels; ++x) {
    const int dx = line[x + 1] - line[x - 1], dy = below[x] - above[x];
    const int ax = dx < 0 ? -dx : dx, ay = dy < 0 ? -dy : dy, difference = ax - ay;
    const unsigned is_steep = static_cast<unsigned>(difference) >> 31;
    const unsigned octant =
        static_cast<unsigned>(dx) >> 31 | (static_cast<unsigned>(dy) >> 31) << 1 | is_steep << 2;
    const int along_axis = difference < 0 ? -difference : difference;
    sums->octant[octant] += static_cast<unsigned>(along_axis) << 16 | static_cast<unsigned>(smaller(ax, ay));
    sums->brightness += line[x];
  }
}

CellSums cell_of(const OctantSums& s) {
  const unsigned axes[4] = {s.axis(0) + s.axis(2), s.axis(4) + s.axis(5), s.axis(1) + s.axis(3),
                            s.axis(6) + s.axis(7)};
  const unsigned diagonals[4] = {s.diagonal(0) + s.diagonal(4), s.diagonal(1) + s.diagonal(5),
                                 s.diagonal(3) + s.diagonal(7), s.diagonal(2) + s.diagonal(6)};
  CellSums cell{};
  unsigned total = 0;
  for (int k = 0; k < 4; ++k) {
    const unsigned diagonal = (diagonals[k] * kDiagonalGain) >> 7;
    cell.direction[2 * k] = static_cast<std::uint16_t>(axes[k]);
    cell.direction[2 * k + 1] = static_cast<std::uint16_t>(diagonal);
    total += axes[k] + diagonal;
  }
  cell.total = static_cast<std::uint16_t>(total);
  cell.brightness = static_cast<std::uint16_t>(s.brightness);
  return cell;
}

// Sums over a column of neighbouring cells.
struct Neighbourhood {
  std::uint32_t total = 0, brightness = 0, cells = 0;
};

Neighbourhood column_of(const CellRows& around, int column) {
  Neighbourhood n;
  for (int j = 0; j < around.count; ++j) {
    if (around.rows[j] == nullptr) continue;
    n.total += around.rows[j][column].total;
    n.brightness += around.rows[j][column].brightness;
    ++n.cells;
  }
  return n;
}

// Writes the channels of one cell. The reciprocal has 16 fractional bits: no product exceeds 2^30.
void write_cell(const CellSums& cell, const Neighbourhood& n, int cell_px, std::uint8_t* out) {
  const std::uint32_t pixels = static_cast<std::uint32_t>(cell_px * cell_px);
  const std::uint32_t mean = n.total + n.cells * pixels * static_cast<std::uint32_t>(kTuning.noise);
  const std::uint32_t by = ((n.cells * static_cast<std::uint32_t>(kTuning.direction_gain)) << 16) / mean;
  for (int k = 0; k < 8; ++k) {
    const std::uint32_t value = (cell.direction[k] * by) >> 16;
    out[k] = static_cast<std::uint8_t>(value < 255 ? value : 255);
  }
  const std::int32_t difference =
      static_cast<std::int32_t>(cell.brightness * n.cells) - static_cast<std::int32_t>(n.brightness);
  const int relative = 128 + kTuning.brightness_gain * difference / static_cast<std::int32_t>(mean);
  out[8] = static_cast<std::uint8_t>(within(relative, 0, 255));
}

}  // namespace

void sum_cells(const std::uint8_t* first, int stride, int columns, int cell_px, CellSums* out) {
  PLIANT_ASSERT(cell_px >= 1 && cell_px <= kLargestCellPx && columns >= 0);
  for (int c = 0; c < columns; ++c) {
    OctantSums sums{};
    for (int y = 0; y < cell_px; ++y) add_line(first + y * stride + c * cell_px, stride, cell_px, &sums);
    out[c] = cell_of(sums);
  }
}

void normalise_cells(const CellRows& around, int columns, int cell_px, std::uint8_t* out) {
  PLIANT_ASSERT(around.count % 2 == 1 && around.count <= 5 && around.rows[around.count / 2] != nullptr);
  const int reach = around.count / 2;
  const CellSums* const middle = around.rows[reach];
  Neighbourhood n;
  const auto add = [&](int column, std::uint32_t sign) {
    const Neighbourhood c = column_of(around, column);
    n.total += sign * c.total;
    n.brightness += sign * c.brightness;
    n.cells += sign * c.cells;
  };
  for (int c = 0; c < reach && c < columns; ++c) add(c, 1);
  for (int c = 0; c < columns; ++c) {
    if (c + reach < columns) add(c + reach, 1);
    if (c > reach) add(c - reach - 1, ~std::uint32_t{0});  // modulo 2^32: minus
    write_cell(middle[c], n, cell_px, out + c * kCellChannels);
  }
}

void GradientCells::lay_out(Arena& arena, int cells) {
  capacity_ = cells;
  sums_ = arena.take<CellSums>(static_cast<std::size_t>(cells));
}

void GradientCells::compute(const ImageView& image, int columns, int rows, int cell_px, int reach,
                            std::uint8_t* out) {
  PLIANT_ASSERT(columns * rows <= capacity_ && reach >= 0 && reach <= 2);
  PLIANT_ASSERT(image.width >= columns * cell_px + 2 && image.height >= rows * cell_px + 2);
  for (int j = 0; j < rows; ++j)
    sum_cells(image.data + (1 + j * cell_px) * image.stride + 1, image.stride, columns, cell_px,
              sums_ + j * columns);
  for (int j = 0; j < rows; ++j) {
    const CellSums* around[5];
    for (int k = -reach; k <= reach; ++k)
      around[k + reach] = j + k >= 0 && j + k < rows ? sums_ + (j + k) * columns : nullptr;
    normalise_cells({around, 2 * reach + 1}, columns, cell_px, out + j * columns * kCellChannels);
  }
}

}  // namespace pliant
