#pragma once
// The inner loops of the patch tracker: flat loops over 16-bit integers in rows of whole vectors, which
// compilers turn into vector code without intrinsics. Every sum is of integers and cannot overflow (the
// bounds are given), so its value does not depend on the order in which lanes are added: the bits are the
// same everywhere.
#include <cstddef>
#include <cstdint>

namespace pliant::patch {

/// Grey levels are kept as 16 * (grey - 128): 12 bits with sign, four of them fractional.
constexpr int kGreyScale = 16, kGreyOffset = 2048;
/// Positions are sampled on a grid of 1/128 px; what is left over is solved for, not thrown away.
constexpr int kSubpixel = 128;

constexpr int kMinWindow = 7, kMaxWindow = 21;
/// What a row of a window is worked on in: a multiple of 8.
constexpr int lanes(int window) {
  return (window + 7) / 8 * 8;
}
/// Elements of a patch array: the window's rows one right after the other, rounded up to whole vectors. A row is written
/// in lanes, and what reaches beyond it is overwritten by the next; where sums are taken the rest holds zeros.
constexpr int padded(int window) {
  return (window * window + 15) / 16 * 16;
}
/// A block is a window with one more pixel to the left and above, and two to the right and below, in rows of
/// block_stride(window). What kernels read and write past its last row is theirs.
constexpr int block_stride(int window) {
  return (window + 3 + 7) / 8 * 8;
}
constexpr int block_rows(int window) {
  return window + 3;
}
constexpr int block_size(int window) {
  return (block_rows(window) + 2) * block_stride(window) + 64;
}
/// Elements that the kernels may use as they like.
constexpr int scratch_size(int window) {
  return 2 * block_size(window);
}

/// Takes block_stride(window) pixels from each of block_rows(window) rows, `stride` bytes apart.
void load_block(const std::uint8_t* pixels, std::ptrdiff_t stride, int window, std::int16_t* block);

/// Positions in a picture at equal distances on parallel lines, in 1/32768 px.
constexpr int kLatticeBits = 15;
struct Lattice {
  std::int32_t x, y;  ///< of its first point
  std::int32_t across_x, across_y, down_x, down_y;
};
/// Fills a block's first window + 2 rows and columns with bilinear samples on a lattice. The pixels that they are made of
/// must all be there.
void sample_lattice(const std::uint8_t* pixels, int stride, const Lattice& at, int window,
                    std::int16_t* scratch, std::int16_t* block);

/// Samples of the window in a block, moved by (fx, fy) / 128 px, 0 .. 127, row by row:
/// bilinear, or by cubic convolution.
void sample_linear(const std::int16_t* block, int fx, int fy, int window, std::int16_t* scratch,
                   std::int16_t* out);
void sample_cubic(const std::int16_t* block, int fx, int fy, int window, std::int16_t* scratch,
                  std::int16_t* out);

/// What is compared: grey levels, their gradient (1/16 grey a pixel) and 1 or 0 where they count or not; t,
/// gx and gy are zero where m is. Each of padded(window) elements.
struct Template {
  std::int16_t *t, *gx, *gy, *m;
};

/// Fills `out` from a block: Scharr gradients (3 10 3), where `mask` is 1 and the pixel within (lowest,
/// highest).
void make_template(const std::int16_t* block, const std::int16_t* mask, int window, int lowest, int highest,
                   std::int16_t* scratch, Template out);

/// Whether all elements lie within (lowest, highest).
bool is_within(const std::int16_t* v, int count, int lowest, int highest);

/// out = 1 where m is and the image lies within (lowest, highest). Gives the number of ones.
int mask_extremes(const std::int16_t* image, const std::int16_t* m, int count, int lowest, int highest,
                  std::int16_t* out);
/// out = in * m.
void apply_mask(const std::int16_t* in, const std::int16_t* m, int count, std::int16_t* out);

/// out = (x * g) / 16 and (y * g) / 16 over a window, x and y from its middle: how the image changes when it
/// is stretched or turned. At most 1280 in magnitude.
void multiply_by_position(const std::int16_t* g, const std::int16_t* x, const std::int16_t* y, int count,
                          std::int16_t* by_x, std::int16_t* by_y);

/// Sums of products of one array with others. |elements| <= 2048 and at most 441 of them are not zero:
/// 441 * 2048^2 < 2^31 bounds every sum.
struct Sums4 {
  std::int32_t a, b, c, d;
};
Sums4 dot4(const std::int16_t* v, const std::int16_t* a, const std::int16_t* b, const std::int16_t* c,
           const std::int16_t* d, int count);
std::int32_t dot(const std::int16_t* v, const std::int16_t* a, int count);
/// Sum of the squares of v where m is 1.
std::int32_t sum_squares(const std::int16_t* v, const std::int16_t* m, int count);

}  // namespace pliant::patch
