#include "face/gradient_cells.hpp"

namespace pliant {

namespace {

/// Tuning of gradient cells. Each constant: unit, reason, experiment.
struct GradientCellTuning {
  /// Added to the mean gradient, grey levels in two pixels: flat places with noise of about 2 grey levels stay near
  /// zero. Not tuned.
  int noise = 4;
  /// A cell with one direction as strong as the whole neighbourhood's mean gets this value. A single edge among flat cells
  /// reaches about twice the mean, that is 255. Not tuned.
  int direction_gain = 128;
  /// Of brightness, against the mean gradient. Not tuned.
  int brightness_gain = 24;
};
constexpr GradientCellTuning kTuning{};

constexpr int kBlockPx = 32;        // pixels that are summed at once: fits registers and a small stack
constexpr int kDiagonalGain = 181;  // sqrt(2) * 128: (1, 1) as a multiple of the diagonal's unit vector

// Sums along columns of pixels, by direction.
struct ColumnSums {
  std::uint16_t direction[8][kBlockPx], brightness[kBlockPx];
};

constexpr int smaller(int a, int b) {
  return a < b ? a : b;
}

constexpr std::int16_t positive(int x) {
  return static_cast<std::int16_t>(x > 0 ? x : 0);
}

// Adds the gradients of one line of pixels. A gradient between an axis and a diagonal is the sum of one vector along each:
// (dx, dy) = (dx - dy) (1, 0) + dy (1, 1) for 0 <= dy <= dx, so that each part costs a minimum or maximum.
void add_line(const std::uint8_t* line, int stride, int pixels, ColumnSums* sums) {
  const std::uint8_t *above = line - stride, *below = line + stride;
  auto& d = sums->direction;
  for (int x = 0; x < pixels; ++x) {
    const int dx = line[x + 1] - line[x - 1], dy = below[x] - above[x];
    const int ax = dx < 0 ? -dx : dx, ay = dy < 0 ? -dy : dy;
    const auto add = [x](std::uint16_t* to, int value) {
      to[x] = static_cast<std::uint16_t>(to[x] + positive(value));
    };
    add(d[0], dx - ay);
    add(d[1], smaller(dx, dy));
    add(d[2], dy - ax);
    add(d[3], smaller(-dx, dy));
    add(d[4], -dx - ay);
    add(d[5], smaller(-dx, -dy));
    add(d[6], -dy - ax);
    add(d[7], smaller(dx, -dy));
    sums->brightness[x] = static_cast<std::uint16_t>(sums->brightness[x] + line[x]);
  }
}

// The sums of the cell whose first column is `x`.
CellSums cell_of(const ColumnSums& sums, int x, int cell_px) {
  CellSums cell{};
  int total = 0;
  for (int k = 0; k < 8; ++k) {
    int sum = 0;
    for (int i = 0; i < cell_px; ++i) sum += sums.direction[k][x + i];
    if (k % 2 == 1) sum = (sum * kDiagonalGain) >> 7;
    cell.direction[k] = static_cast<std::uint16_t>(sum);
    total += sum;
  }
  cell.total = static_cast<std::uint16_t>(total);
  int brightness = 0;
  for (int i = 0; i < cell_px; ++i) brightness += sums.brightness[x + i];
  cell.brightness = static_cast<std::uint16_t>(brightness);
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
  out[8] = static_cast<std::uint8_t>(relative < 0 ? 0 : smaller(relative, 255));
}

}  // namespace

void sum_cells(const std::uint8_t* first, int stride, int columns, int cell_px, CellSums* out) {
  PLIANT_ASSERT(cell_px >= 1 && cell_px <= kLargestCellPx && columns >= 0);
  const int cells_a_block = kBlockPx / cell_px;
  for (int c = 0; c < columns; c += cells_a_block) {
    const int cells = smaller(cells_a_block, columns - c);
    ColumnSums sums{};
    for (int y = 0; y < cell_px; ++y)
      add_line(first + y * stride + c * cell_px, stride, cells * cell_px, &sums);
    for (int i = 0; i < cells; ++i) out[c + i] = cell_of(sums, i * cell_px, cell_px);
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
