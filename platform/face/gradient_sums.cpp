#include "face/gradient_sums.hpp"

#include <cstring>

#include "base/lanes.hpp"
#include "base/wide_vectors.hpp"
#include "face/gradient_parts.hpp"

// Clang, and GCC from 12 on, can move vectors' lanes.
#if PLIANT_HAS_VECTORS && __has_builtin(__builtin_shufflevector)
#define PLIANT_SUMS_VECTORS 1
#else
#define PLIANT_SUMS_VECTORS 0
#endif

namespace pliant {

namespace {

/// Of a sum of parts, by direction, times 128.
constexpr std::uint16_t kGains[kBlockChannels] = {128, kDiagonalGain, 128, kDiagonalGain,
                                                  128, kDiagonalGain, 128, kDiagonalGain};

#if PLIANT_SUMS_VECTORS

constexpr int kShorts = 8;
static_assert(kShorts == kBlockChannels, "");
typedef std::uint16_t Shorts __attribute__((vector_size(2 * kShorts)));
typedef std::int16_t SignedShorts __attribute__((vector_size(2 * kShorts)));

Shorts load(const std::uint16_t* at) {
  Shorts v;
  std::memcpy(&v, at, sizeof v);
  return v;
}

void store(Shorts v, std::uint16_t* at) {
  std::memcpy(at, &v, sizeof v);
}

/// All bits of a lane are its highest one.
Shorts spread_sign(Shorts v) {
  return reinterpret_cast<Shorts>(reinterpret_cast<SignedShorts>(v) >> 15);
}

/// Lane x of v[d] becomes lane d of v[x]: to interleave the lower and the upper half three times transposes.
void transpose(Shorts (&v)[kShorts]) {
  for (int round = 0; round < 3; ++round) {
    Shorts next[kShorts];
    for (int k = 0; k < kShorts / 2; ++k) {
      next[2 * k] = __builtin_shufflevector(v[k], v[k + 4], 0, 8, 1, 9, 2, 10, 3, 11);
      next[2 * k + 1] = __builtin_shufflevector(v[k], v[k + 4], 4, 12, 5, 13, 6, 14, 7, 15);
    }
    for (int k = 0; k < kShorts; ++k) v[k] = next[k];
  }
}

/// Adds the parts of eight neighbouring columns, by direction.
void add_columns(const std::uint16_t* from, int stride, int rows, Shorts (&sums)[kBlockChannels]) {
  for (; rows > 0; --rows, from += stride) {
    const Shorts gradient = load(from);
    const Shorts is_left = spread_sign(gradient), is_up = spread_sign(gradient << 1),
                 is_steep = spread_sign(gradient << 2);
    const Shorts axis = (gradient >> kDiagonalBits) & kMostAxis, diagonal = gradient & kMostDiagonal;
    const Shorts flat = axis & ~is_steep, steep = axis & is_steep, right = diagonal & ~is_left,
                 left = diagonal & is_left;
    sums[0] += flat & ~is_left;
    sums[1] += right & ~is_up;
    sums[2] += steep & ~is_up;
    sums[3] += left & ~is_up;
    sums[4] += flat & is_left;
    sums[5] += left & is_up;
    sums[6] += steep & is_up;
    sums[7] += right & is_up;
  }
}

/// A row of cells, from the sums of their columns.
void sum_row(const std::uint16_t* first, int stride, int cells, int cell_px, std::uint16_t* out) {
  const int columns = cells * cell_px;
  Shorts cell{};
  int left = cell_px;  // columns of the cell that are not in it yet
  for (int x = 0; x < columns; x += kShorts) {
    Shorts sums[kBlockChannels] = {};
    add_columns(first + x, stride, cell_px, sums);
    transpose(sums);
    for (int k = 0; k < kShorts && x + k < columns; ++k) {
      cell += sums[k];
      if (--left > 0) continue;
      store(cell, out);
      out += kBlockChannels;
      cell = Shorts{};
      left = cell_px;
    }
  }
}

#else

// The two directions of the highest three bits.
constexpr std::uint8_t kAxis[8] = {0, 2, 0, 6, 4, 2, 4, 6};
constexpr std::uint8_t kDiagonal[8] = {1, 1, 7, 7, 3, 3, 5, 5};

void sum_cell(const std::uint16_t* first, int stride, int cell_px, std::uint16_t* sums) {
  constexpr int kShift = 16 - kDiagonalBits;
  std::uint32_t by_octant[8] = {};  // along the axis in the upper half, along the diagonal in the lower one
  for (int j = 0; j < cell_px; ++j, first += stride)
    for (int i = 0; i < cell_px; ++i) {
      const std::uint32_t gradient = first[i];
      by_octant[gradient >> kPartBits] += (gradient << kShift & kMostAxis << 16) | (gradient & kMostDiagonal);
    }
  std::uint32_t by_direction[kBlockChannels] = {};
  for (int octant = 0; octant < 8; ++octant) {
    by_direction[kAxis[octant]] += by_octant[octant] >> 16;
    by_direction[kDiagonal[octant]] += by_octant[octant] & 0xffff;
  }
  for (int d = 0; d < kBlockChannels; ++d)
    sums[d] = static_cast<std::uint16_t>((by_direction[d] * kGains[d]) >> 7);
}

#endif

}  // namespace

#if PLIANT_SUMS_VECTORS

PLIANT_WIDE_VECTORS
void sum_block(const std::uint16_t* first, int stride, int cells, int cell_px, std::uint16_t* sums) {
  std::uint16_t* out = sums;
  for (int j = 0; j < cells; ++j, first += cell_px * stride, out += cells * kBlockChannels)
    sum_row(first, stride, cells, cell_px, out);
  for (; sums != out; sums += kBlockChannels)
    for (int d = 0; d < kBlockChannels; ++d)  // all eight, as a vector
      sums[d] = static_cast<std::uint16_t>(std::uint32_t{sums[d]} * kGains[d] >> 7);
}

#else

void sum_block(const std::uint16_t* first, int stride, int cells, int cell_px, std::uint16_t* sums) {
  for (int j = 0; j < cells; ++j, first += cell_px * stride)
    for (int i = 0; i < cells; ++i, sums += kBlockChannels)
      sum_cell(first + i * cell_px, stride, cell_px, sums);
}

#endif

}  // namespace pliant
