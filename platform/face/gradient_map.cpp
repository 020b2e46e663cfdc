#include "face/gradient_map.hpp"

#include "base/integers.hpp"
#include "base/lanes.hpp"
#include "base/wide_vectors.hpp"
#include "face/gradient_sums.hpp"
#include "vision/halfwords.hpp"

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
      root[x] = static_cast<std::uint8_t>(smaller(r, 255));
    }
  }
};
constexpr RootTable kRoots{};

/// First pixel of a block along an axis; 0 where the position is not a number.
int first_of(float at, int block, int side) {
  const float first = at - 0.5f * static_cast<float>(block - 1) + 0.5f;
  return static_cast<int>(min(max(0, first), static_cast<float>(side - block)));
}

/// The gradients of a row of pixels. The lines have one pixel more on each side.
PLIANT_WIDE_VECTORS
void gradients_of_row(const std::uint8_t* above, const std::uint8_t* line, const std::uint8_t* below,
                      int count, std::uint16_t* out) {
  for (int x = 1; x <= count; ++x) {
    const int dx = line[x + 1] - line[x - 1], dy = below[x] - above[x];
    // Without branches, which would be taken at random: a mask is -1 where its condition holds, else 0.
    const int is_left = dx >> 31, is_up = dy >> 31;
    const int ax = (dx ^ is_left) - is_left, ay = (dy ^ is_up) - is_up;
    const int difference = ax - ay, is_steep = difference >> 31;
    const int axis = (difference ^ is_steep) - is_steep, diagonal = ay + (difference & is_steep);
    out[x - 1] = static_cast<std::uint16_t>(((is_left & 4) | (is_up & 2) | (is_steep & 1)) << kPartBits |
                                            (smaller(axis, kMostAxis) << kDiagonalBits) |
                                            smaller(diagonal, kMostDiagonal));
  }
}

/// The roots of what part of their total each sum is. \param noise  is a part of the total.
/// With vectors, only the square roots are left to a loop of their own.
PLIANT_WIDE_VECTORS
void write_roots(const std::uint16_t* sums, int count, std::uint32_t noise, std::uint8_t* out) {
  std::uint32_t total = noise;
  for (int k = 0; k < count; ++k) total += sums[k];
  // No sum exceeds the total, so that no product exceeds steps * count * 2^16 = 2^29.
  const std::uint32_t by = ((kTuning.steps_a_mean * static_cast<std::uint32_t>(count)) << 16) / total;
  for (int k = 0; k < count; ++k) {
    const std::uint32_t part = (sums[k] * by) >> 16;
    const auto byte = static_cast<std::uint8_t>(part < 255 ? part : 255);
    out[k] = kHasVectors ? byte : kRoots.root[byte];
  }
  for (int k = 0; kHasVectors && k < count; ++k) out[k] = kRoots.root[out[k]];
}

void reverse(std::uint8_t* row, int count) {
  for (int i = 0, j = count - 1; i < j; ++i, --j) {
    const std::uint8_t kept = row[i];
    row[i] = row[j];
    row[j] = kept;
  }
}

}  // namespace

void GradientMap::lay_out(Arena& arena, int most_side) {
  PLIANT_ASSERT(most_side >= 1 && most_side <= kMostCropPx);
  most_side_ = most_side;
  const auto side = static_cast<std::size_t>(most_side);
  gradients_ = arena.take<std::uint16_t>(side * side + kReadBeyondBlock);
  sums_ =
      arena.take<std::uint16_t>(static_cast<std::size_t>(kMostBlockCells) * kMostBlockCells * kBlockChannels);
}

void GradientMap::compute(const FacePicture& picture, const CropMap& map, bool is_mirrored) {
  PLIANT_ASSERT(map.side >= 1 && map.side <= most_side_);
  side_ = map.side;
  std::uint8_t rows[3][kMostCropPx + 2];
  const CropReader reader(picture, map);
  const auto read = [&](int y, std::uint8_t* row) {
    reader.read_row(y, row);
    if (is_mirrored) reverse(row, side_ + 2);
  };
  read(-1, rows[0]);
  read(0, rows[1]);
  for (int y = 0; y < side_; ++y) {
    read(y + 1, rows[(y + 2) % 3]);
    gradients_of_row(rows[y % 3], rows[(y + 1) % 3], rows[(y + 2) % 3], side_, gradients_ + y * side_);
  }
}

Vec2 GradientMap::describe(Vec2 at, int cells, int cell_px, std::uint8_t* out) const {
  const int block = cells * cell_px, values = cells * cells * kBlockChannels;
  PLIANT_ASSERT(block <= side_ && cells <= kMostBlockCells);
  const int x = first_of(at.x, block, side_), y = first_of(at.y, block, side_);
  sum_block(gradients_ + y * side_ + x, side_, cells, cell_px, sums_);
  write_roots(sums_, values, static_cast<std::uint32_t>(block * block) * kTuning.noise, out);
  const float half = 0.5f * static_cast<float>(block - 1);
  return {static_cast<float>(x) + half, static_cast<float>(y) + half};
}

void mirror_block(const std::uint8_t* block, int cells, std::uint8_t* out) {
  for (int j = 0; j < cells; ++j)
    for (int i = cells - 1; i >= 0; --i, out += kBlockChannels) {
      const std::uint8_t* const from = block + (j * cells + i) * kBlockChannels;
      for (int d = 0; d < kBlockChannels; ++d) out[d] = from[(4 - d) & 7];
    }
}

PLIANT_WIDE_VECTORS
std::int32_t dot_bytes(const std::int8_t* weight, const std::uint8_t* value, std::size_t count) {
  std::int32_t sum = 0;
  std::size_t k = 0;
#if PLIANT_HAS_HALFWORDS
  using namespace patch;
  for (; k + 4 <= count; k += 4) {
    const std::uint32_t weights = load_bytes(weight + k), values = load_bytes(value + k);
    sum = add_products(signed_even_bytes(weights), add_even_bytes(0, values), sum);
    sum = add_products(signed_odd_bytes(weights), add_odd_bytes(0, values), sum);
  }
#endif
  for (; k < count; ++k) sum += weight[k] * value[k];
  return sum;
}

}  // namespace pliant
