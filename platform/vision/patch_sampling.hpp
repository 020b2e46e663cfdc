#pragma once
// Sampling of an image between pixels, for a whole window at once.
#include <cstddef>

#include "vision/patch_arrays.hpp"

namespace pliant::patch {

/// Copies block_stride(window) pixels of each of block_rows(window) rows into a block, in the units of
/// patch_arrays.hpp.
/// \param stride  bytes from one row of pixels to the next.
void load_block(const std::uint8_t* pixels, std::ptrdiff_t stride, int window, i16* block);

/// Samples the window of a block, moved by (fx, fy) / 128 px, bilinearly. fx and fy: 0 to 127.
/// \param scratch  scratch_size(window) elements. \param out  padded(window) elements and a vector's slack.
void sample_linear(const i16* block, int fx, int fy, int window, i16* scratch, i16* out);
/// The same by cubic convolution (Catmull and Rom): twice the cost, a smaller error of the sub-pixel phase.
void sample_cubic(const i16* block, int fx, int fy, int window, i16* scratch, i16* out);

/// Positions at equal distances on parallel lines of an image, in 1/32768 px: (i, j) -> first + i across + j down.
constexpr int kLatticeBits = 15;
struct Lattice {
  i32 x, y;  ///< of its first point
  i32 across_x, across_y, down_x, down_y;
};
/// Fills the first window + 2 rows and columns of a block with bilinear samples on a lattice. Precondition: the four
/// pixels around each position exist.
void sample_lattice(const std::uint8_t* pixels, int stride, const Lattice& at, int window, i16* scratch,
                    i16* block);

}  // namespace pliant::patch
