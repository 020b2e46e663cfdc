#pragma once
// Masks, products and sums over the arrays of a window.
#include "vision/halfwords.hpp"
#include "vision/patch_arrays.hpp"
#include "vision/patch_tuning.hpp"

namespace pliant::patch {

/// Grey levels strictly between these count, in the units of patch_arrays.hpp.
struct GreyRange {
  i16 lowest, highest;
};
inline constexpr GreyRange kUsableGrey{narrow(kPatchTuning.lowest_grey * kGreyScale - kGreyOffset),
                                       narrow(kPatchTuning.highest_grey* kGreyScale - kGreyOffset)};

// In all of these `count` is padded(window), a multiple of 16.

/// True if all elements lie within the range.
bool is_within(const i16* v, int count, GreyRange range);
/// out = m where the image lies within the range, otherwise 0. m holds zeros and ones.
/// \return the number of ones.
int mask_extremes(const i16* image, const i16* m, int count, GreyRange range, i16* out);
/// out = in * m.
void apply_mask(const i16* in, const i16* m, int count, i16* out);

/// by_x = x g / 16 and by_y = y g / 16: how an image of gradient g changes when it is stretched or turned about the
/// point from which x and y count. At most 1280 in magnitude.
void multiply_by_position(const i16* g, const i16* x, const i16* y, int count, i16* by_x, i16* by_y);

// Sums of products. |elements| <= 2048, at most 441 of them not zero: 441 * 2048^2 < 2^31 bounds every sum.

struct Sums4 {
  i32 a, b, c, d;
};
/// Sums of v times each of four arrays.
Sums4 dot4(const i16* v, const i16* a, const i16* b, const i16* c, const i16* d, int count);
i32 dot(const i16* v, const i16* a, int count);

/// Sums of the products of four arrays.
struct Sums10 {
  i32 aa, ab, ac, ad, bb, bc, bd, cc, cd, dd;
};
#if PLIANT_HAS_HALFWORDS
// Here, because every function that calls `dot4` beside it would get a copy of that.
inline Sums10 products_of(const i16* a, const i16* b, const i16* c, const i16* d, int count) {
  const Sums4 of_a = dot4(a, a, b, c, d, count), of_b = dot4(b, b, c, d, a, count),
              of_c = dot4(c, c, d, a, a, count);
  return {of_a.a, of_a.b, of_a.c, of_a.d, of_b.a, of_b.b, of_b.c, of_c.a, of_c.b, dot(d, d, count)};
}
#else
Sums10 products_of(const i16* a, const i16* b, const i16* c, const i16* d, int count);
#endif
/// Sum of the squares of v where m is 1.
i32 sum_squares(const i16* v, const i16* m, int count);

/// The nearest float of an integer below 2^53 in magnitude. A double that the processor has is exact on the
/// way and saves the call of a function.
inline float nearest_float(std::int64_t v) {
#if defined(__ARM_FP) && (__ARM_FP & 8) && !defined(__aarch64__)
  return static_cast<float>(4294967296.0 * static_cast<std::int32_t>(v >> 32) +
                            static_cast<std::uint32_t>(v));
#else
  return static_cast<float>(v);
#endif
}

/// Sum of (a - mean a) (b - mean b) over n pixels from the plain sums. Exact but for two roundings at the end.
inline float centred(i32 n, float inverse_n, i32 ab, i32 a, i32 b) {
  return nearest_float(std::int64_t{n} * ab - std::int64_t{a} * b) * inverse_n;
}

}  // namespace pliant::patch
