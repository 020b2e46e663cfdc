#pragma once
// Units and sizes of the arrays that the kernels of the patch tracker work on, and common parts of their loops.
//
// The kernels are flat loops over 16-bit integers in rows of whole vectors, which compilers turn into vector code
// without intrinsics. Two rules make them do so: a loop runs over a whole array, and every intermediate value is cast
// back to 16 bits, where it is known to fit. All sums are of integers and cannot overflow, so that their values do
// not depend on the order of the lanes: the bits are the same on every target.
#include <cstdint>

#include "pliant/status.hpp"

namespace pliant::patch {

/// Grey levels are stored as 16 * (grey - 128): 12 bits with sign, four of them fractional.
constexpr int kGreyScale = 16, kGreyOffset = 2048;
/// Images are sampled on a grid of 1/128 px. The remainder of a position is part of the solved step.
constexpr int kSubpixel = 128;

/// Side of a window, px: odd and within these.
constexpr int kMinWindow = 7, kMaxWindow = 21;
constexpr bool is_window(int window) {
  return window >= kMinWindow && window <= kMaxWindow && window % 2 == 1;
}
/// Elements that a row of a window is computed in: a multiple of 8.
constexpr int lanes(int window) {
  return (window + 7) / 8 * 8;
}
/// Elements of an array of a window's pixels: its rows one after the other, rounded up to whole vectors. A row is
/// written in `lanes`; the next row overwrites the elements beyond its end. An array that is summed has zeros
/// after its last row.
constexpr int padded(int window) {
  return (window * window + 15) / 16 * 16;
}
/// A block is a window with one more pixel to the left and above, and two to the right and below, in rows of
/// block_stride(window) elements. Kernels may read and write behind its last row, up to block_size(window).
constexpr int block_stride(int window) {
  return (window + 3 + 7) / 8 * 8;
}
constexpr int block_rows(int window) {
  return window + 3;
}
constexpr int block_size(int window) {
  return (block_rows(window) + 2) * block_stride(window) + 64;
}
/// Elements of scratch that a kernel may use.
constexpr int scratch_size(int window) {
  return 2 * block_size(window);
}

using i16 = std::int16_t;
using u16 = std::uint16_t;
using i32 = std::int32_t;

constexpr i16 narrow(i32 v) {
  return static_cast<i16>(v);
}
/// Upper half of a 32-bit product.
constexpr i16 mulhi(i16 a, i16 b) {
  return narrow((i32{a} * b) >> 16);
}
/// `count`, rounded up to whole vectors. The elements beyond `count` are in the slack of the arrays.
constexpr int whole_vectors(int count) {
  return (count + 15) & ~15;
}

template <int L, int S>
struct Sizes {
  static constexpr int kLanes = L, kStride = S;
};
/// Calls f with the lanes and the block's stride of a window as constants.
template <class F>
void with_sizes(int window, F&& f) {
  PLIANT_ASSERT(is_window(window));
  const int l = lanes(window);
  if (l == 8) f(Sizes<8, 16>{});
  if (l == 16 && block_stride(window) == 16) f(Sizes<16, 16>{});
  if (l == 16 && block_stride(window) == 24) f(Sizes<16, 24>{});
  if (l == 24) f(Sizes<24, 24>{});
}

}  // namespace pliant::patch
