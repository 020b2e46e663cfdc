#pragma once
// Bilinear interpolation of 8-bit pixels.
#include <cstddef>
#include <cstdint>

namespace pliant {

/// Sample in 1/16 grey between four pixels: two of a line, two of the line below. Integers only.
/// \param fx, fy  fractions of a pixel in 1/256, 0 to 255.
inline int bilinear_sixteenths(int upper_left, int upper_right, int lower_left, int lower_right, int fx,
                               int fy) {
  const int upper = upper_left * 256 + (upper_right - upper_left) * fx;
  const int lower = lower_left * 256 + (lower_right - lower_left) * fx;
  return (upper * 256 + (lower - upper) * fy + 2048) >> 12;
}
/// The same between p, its right neighbour and the two pixels below, `stride` bytes on.
inline int bilinear_sixteenths(const std::uint8_t* p, std::ptrdiff_t stride, int fx, int fy) {
  return bilinear_sixteenths(p[0], p[1], p[stride], p[stride + 1], fx, fy);
}

/// Sample in whole greys between four pixels: two of a line, two of the line below. Integers only. \param fx, fy  as above.
inline std::uint8_t bilinear_grey(int upper_left, int upper_right, int lower_left, int lower_right, int fx,
                                  int fy) {
  const int upper = upper_left * 256 + (upper_right - upper_left) * fx;
  const int lower = lower_left * 256 + (lower_right - lower_left) * fx;
  return static_cast<std::uint8_t>((upper * 256 + (lower - upper) * fy + 32768) >> 16);
}

/// Sample in grey between upper[0], upper[right], lower[0] and lower[right]; fx and fy: 0 to 1.
inline float bilinear(const std::uint8_t* upper, const std::uint8_t* lower, int right, float fx, float fy) {
  const float top = static_cast<float>(upper[0]) + fx * static_cast<float>(upper[right] - upper[0]);
  const float bottom = static_cast<float>(lower[0]) + fx * static_cast<float>(lower[right] - lower[0]);
  return top + fy * (bottom - top);
}

}  // namespace pliant
