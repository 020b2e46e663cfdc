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

/// The samples at the corners of a cell.
struct LaneCorners {
  Lanes s00, s10, s01, s11;

  /// \param p  the first of them.
  LaneCorners(const Field& f, const std::uint8_t* p) {
    // Two samples are 12 bytes, and nothing is read beyond: the second one is read from the third component of the first on.
    const std::uint8_t* const next_row = p + std::size_t{6} * f.width;
    s00 = read_lanes(p);
    s10 = read_lanes(p + 4, 16);
    s01 = read_lanes(next_row);
    s11 = read_lanes(next_row + 4, 16);
  }
};

inline Lanes first_three(const float* v) {
  return Lanes{v[0], v[1], v[2], 0};
}

/// Of a mirrored field x has the other sign.
inline Vec3 reflected(Lanes v, const Field& f) {
  return {f.mirror ? -v[0] : v[0], v[1], v[2]};
}

/// Bilinear value at (a, b) of a cell, in the field's steps.
inline Lanes lane_steps(const LaneCorners& s, float a, Lanes b) {
  const Lanes along_u = splat(a);
  const Lanes top = s.s00 + along_u * (s.s10 - s.s00), bottom = s.s01 + along_u * (s.s11 - s.s01);
  return top + b * (bottom - top);
}
inline Vec3 lane_value(const LaneCorners& s, const Field& f, float a, float b) {
  return reflected(first_three(f.offset) + first_three(f.scale) * lane_steps(s, a, splat(b)), f);
}

/// Its derivatives; `per_u` and `per_v` are cells per unit of u and v, the first negative for a mirrored field.
inline void lane_gradient(const LaneCorners& s, const Field& f, float a, float b, float per_u, float per_v,
                          Vec3* du, Vec3* dv) {
  const Lanes top = s.s10 - s.s00, left = s.s01 - s.s00, scale = first_three(f.scale);
  *du = reflected(scale * (top + splat(b) * ((s.s11 - s.s01) - top)) * splat(per_u), f);
  *dv = reflected(scale * (left + splat(a) * ((s.s11 - s.s10) - left)) * splat(per_v), f);
}

/// One vector four times, as its components follow each other in memory.
struct FourTimes {
  Lanes part[3];

  FourTimes(float x, float y, float z) : part{{x, y, z, x}, {y, z, x, y}, {z, x, y, z}} {}
  const Lanes& operator[](std::size_t k) const { return part[k]; }
};

/// Adds offset + scale * sample to four vectors each time. \return how many were added, a multiple of four.
inline std::size_t add_lanes(const std::uint8_t* samples, std::size_t count, Vec3 scale, Vec3 offset,
                             Vec3* to) {
  const FourTimes scales(scale.x, scale.y, scale.z), offsets(offset.x, offset.y, offset.z);
  std::size_t n = 0;
  for (; n + 4 <= count; n += 4, samples += 24) {
    float* const sum = &to[n].x;
    for (std::size_t k = 0; k < 3; ++k)
      store(load(sum + 4 * k) + (offsets[k] + scales[k] * read_lanes(samples + 8 * k)), sum + 4 * k);
  }
  return n;
}

/// The samples of four vectors each time: (value - offset) / scale, at most `most` on either side of zero, to the nearest
/// integer. \return how many were written, a multiple of four. \pre the field's scales are positive
inline std::size_t quantise_lanes(Span<const Vec3> values, const Field& f, float most, std::int16_t* to) {
  const FourTimes scales(f.scale[0], f.scale[1], f.scale[2]), offsets(f.offset[0], f.offset[1], f.offset[2]);
  std::size_t n = 0;
  for (; n + 4 <= values.count; n += 4)
    for (std::size_t k = 0; k < 3; ++k)
      store_rounded(limited((load(&values[n].x + 4 * k) - offsets[k]) / scales[k], most), to + 3 * n + 4 * k);
  return n;
}

}  // namespace pliant

#endif
