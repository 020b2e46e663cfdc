#include "face/gradient_block.hpp"

namespace pliant {

namespace {

/// Tuning of gradient blocks. Each constant: unit, reason, experiment.
struct GradientBlockTuning {
  /// Added to the gradient of each pixel, grey levels in two pixels: flat blocks with noise stay near zero. Not tuned.
  std::uint32_t noise = 4;
  /// Sixteenths: a part of this many times the mean part gets the byte 255. Not tuned.
  std::uint32_t steps_a_mean = 16;
};
constexpr GradientBlockTuning kTuning{};

/// Square roots of 0 to 255, times 16, rounded.
struct RootTable {
  std::uint8_t root[256] = {};
  constexpr RootTable() {
    int r = 0;
    for (int x = 0; x < 256; ++x) {
      while ((2 * r + 1) * (2 * r + 1) <= 4 * 256 * x) ++r;
      root[x] = static_cast<std::uint8_t>(r < 255 ? r : 255);
    }
  }
};
constexpr RootTable kRoots{};

/// First pixel of a block along an axis.
int first_of(float at, int block, int side) {
  const float first = at - 0.5f * static_cast<float>(block - 1) + 0.5f;
  return static_cast<int>(clamp(first, 0, static_cast<float>(side - block)));
}

}  // namespace

void GradientBlocks::lay_out(Arena& arena) {
  sums_ = arena.take<CellSums>(kMostBlockCells * kMostBlockCells);
}

Vec2 GradientBlocks::describe(Vec2 at, int cells, int cell_px, std::uint8_t* out) const {
  const int block = cells * cell_px, stride = side_ + 2;
  PLIANT_ASSERT(block <= side_ && cells <= kMostBlockCells);
  const int x = first_of(at.x, block, side_), y = first_of(at.y, block, side_);
  const int count = cells * cells;
  std::uint32_t total = static_cast<std::uint32_t>(block * block) * kTuning.noise;
  for (int j = 0; j < cells; ++j)
    sum_cells(pixels_ + (1 + y + j * cell_px) * stride + 1 + x, stride, cells, cell_px, sums_ + j * cells);
  for (int k = 0; k < count; ++k) total += sums_[k].total;
  // No part exceeds the total, so that no product exceeds steps * values * 2^16 = 2^29.
  const std::uint32_t values = static_cast<std::uint32_t>(count * kBlockChannels);
  const std::uint32_t by = ((kTuning.steps_a_mean * values) << 16) / total;
  for (int k = 0; k < count; ++k)
    for (int d = 0; d < kBlockChannels; ++d) {
      const std::uint32_t part = (sums_[k].direction[d] * by) >> 16;
      *out++ = kRoots.root[part < 255 ? part : 255];
    }
  const float half = 0.5f * static_cast<float>(block - 1);
  return {static_cast<float>(x) + half, static_cast<float>(y) + half};
}

std::int32_t dot_bytes(const std::int8_t* weight, const std::uint8_t* value, std::size_t count) {
  std::int32_t sum = 0;
  for (std::size_t k = 0; k < count; ++k) sum += weight[k] * value[k];
  return sum;
}

}  // namespace pliant
