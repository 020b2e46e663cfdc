#pragma once
// The inner loops of the patch tracker: short loops over 16-bit integers in rows of a fixed number of lanes,
// which compilers turn into vector code without intrinsics. Every sum is of integers and cannot overflow (the
// bounds are given), so its value does not depend on the order in which lanes are added: the bits are the
// same everywhere.
#include <cstddef>
#include <cstdint>

namespace pliant::patch {

/// Grey levels are kept as 16 * grey - 2048: 12 bits with sign, four of them fractional.
constexpr int kGreyScale = 16, kGreyOffset = 2048;
/// Positions are sampled on a grid of 1/128 px; what is left over is solved for, not thrown away.
constexpr int kSubpixel = 128;

constexpr int kMinWindow = 7, kMaxWindow = 21;
/// Row length of a window in lanes: a multiple of 8. Lanes past the window hold zeros.
constexpr int lanes(int window) {
  return (window + 7) / 8 * 8;
}
/// Elements of a patch array: rows * lanes, rounded up to whole vectors; the rest holds zeros.
constexpr int padded(int window) {
  return (window * lanes(window) + 31) / 32 * 32;
}
constexpr int kMaxPadded = padded(kMaxWindow);
/// A block is a window with one more pixel on each side, for gradients.
constexpr int block_stride(int window) {
  return lanes(window) + 8;
}
constexpr int block_size(int window) {
  return (window + 2) * block_stride(window);
}
constexpr int kMaxBlock = block_size(kMaxWindow);

/// Pixels in rows of `stride` bytes.
struct Pixels {
  const std::uint8_t* data;
  std::ptrdiff_t stride;
};

/// Bilinear samples of `window` rows at the phase (fx, fy) / 128 in 0 .. 127, into rows of lanes(window).
/// Reads (window + 1) rows of lanes(window) + 1 bytes.
void sample(Pixels in, int fx, int fy, int window, std::int16_t* out);

/// The (window + 2) rows of whole pixels, into rows of block_stride(window). Reads that many bytes a row.
void load_block(Pixels in, int window, std::int16_t* block);

/// What is compared: grey levels, their gradient (1/16 grey a pixel) and 1 or 0 where they count or not; g, x
/// and y are zero where m is. Each of padded(window) elements.
struct Template {
  std::int16_t *t, *gx, *gy, *m;
};

/// Fills `out` from a block: Scharr gradients (3 10 3), masked by out.m as it stands, and to pixels within
/// (lowest, highest).
void make_template(const std::int16_t* block, int window, int lowest, int highest, Template out);

/// `in` masked further to where `image` lies within (lowest, highest).
void mask_template(const Template& in, const std::int16_t* image, int count, int lowest, int highest,
                   Template out);

/// True if any of the pixels that count lies outside (lowest, highest).
bool has_extremes(const std::int16_t* image, const std::int16_t* m, int count, int lowest, int highest);

/// Sums over a template. |t|, |g| <= 2048 and count <= 441, so that 441 * 2048^2 < 2^31 bounds each of them.
struct TemplateSums {
  std::int32_t n, t, gx, gy, tt, tx, ty, xx, xy, yy;
};
TemplateSums sum_template(const Template& in, int count);

/// Sums of an image patch against a template, over the pixels that count.
struct ImageSums {
  std::int32_t i, ti, xi, yi;
};
ImageSums sum_image(const Template& in, const std::int16_t* image, int count);

/// Sum of the squares of an image patch over the pixels that count.
std::int32_t sum_squares(const std::int16_t* image, const std::int16_t* m, int count);

}  // namespace pliant::patch
