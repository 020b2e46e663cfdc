#pragma once
// Samples of vector fields with two bytes a component, four components at a time, where the processor has vectors. The results are
// those of one component after the other.
#include <cstring>

#include "base/lanes.hpp"
#include "pliant/model.hpp"

#if PLIANT_HAS_VECTORS

namespace pliant {

/// Four components from `at` on.
inline Lanes read_lanes(const std::uint8_t* at, int skipped_bits = 0) {
  std::uint64_t word;
  std::memcpy(&word, at, sizeof word);
  return to_lanes(word >> skipped_bits);
}

/// Bilinear value of a field in a cell at (a, b) of it. \param p  the cell's first sample.
inline Vec3 sample_lanes(const Field& f, const std::uint8_t* p, float a, float b) {
  // Two samples are 12 bytes, and nothing is read beyond: the second one without its last two bytes' neighbour.
  const auto first = [](const std::uint8_t* row) { return read_lanes(row); };
  const auto second = [](const std::uint8_t* row) { return read_lanes(row + 4, 16); };
  const std::uint8_t* const next_row = p + std::size_t{6} * f.width;
  const Lanes s00 = first(p), s01 = first(next_row), along_u = splat(a), along_v = splat(b);
  const Lanes top = s00 + along_u * (second(p) - s00), bottom = s01 + along_u * (second(next_row) - s01);
  const Lanes scale{f.scale[0], f.scale[1], f.scale[2], 0}, offset{f.offset[0], f.offset[1], f.offset[2], 0};
  const Lanes value = offset + scale * (top + along_v * (bottom - top));
  return {f.mirror ? -value[0] : value[0], value[1], value[2]};
}

/// Adds offset + scale * sample to four vectors each time. \return how many were added, a multiple of four.
inline std::size_t add_lanes(const std::uint8_t* samples, std::size_t count, Vec3 scale, Vec3 offset,
                             Vec3* to) {
  const auto repeated = [](Vec3 v, Lanes(&out)[3]) {
    out[0] = Lanes{v.x, v.y, v.z, v.x};
    out[1] = Lanes{v.y, v.z, v.x, v.y};
    out[2] = Lanes{v.z, v.x, v.y, v.z};
  };
  Lanes scales[3], offsets[3];
  repeated(scale, scales);
  repeated(offset, offsets);
  std::size_t n = 0;
  for (; n + 4 <= count; n += 4, samples += 24) {
    float* const sum = &to[n].x;
    for (std::size_t k = 0; k < 3; ++k)
      store(load(sum + 4 * k) + (offsets[k] + scales[k] * read_lanes(samples + 8 * k)), sum + 4 * k);
  }
  return n;
}

}  // namespace pliant

#endif
