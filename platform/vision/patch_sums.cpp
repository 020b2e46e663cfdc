#include "vision/patch_sums.hpp"

#include "base/wide_vectors.hpp"
#include "vision/patch_pairs.hpp"

// With count & ~15 the compiler generates loops over whole vectors only.
namespace pliant::patch {

#if PLIANT_HAS_HALFWORDS

bool is_within(const i16* v, int count, GreyRange range) {
  return pairs::is_within(v, count, range);
}
void multiply_by_position(const i16* g, const i16* x, const i16* y, int count, i16* by_x, i16* by_y) {
  pairs::multiply_by_position(g, x, y, count, by_x, by_y);
}
Sums4 dot4(const i16* v, const i16* a, const i16* b, const i16* c, const i16* d, int count) {
  return pairs::dot4(v, a, b, c, d, count);
}
i32 dot(const i16* v, const i16* a, int count) {
  return pairs::dot(v, a, count);
}

#else

PLIANT_WIDE_VECTORS
bool is_within(const i16* __restrict v, int count, GreyRange range) {
  PLIANT_ASSERT(count % 16 == 0);
  const int n = count & ~15;
  i16 low = range.highest, high = range.lowest;
  for (int k = 0; k < n; ++k) {
    low = v[k] < low ? v[k] : low;
    high = v[k] > high ? v[k] : high;
  }
  return low > range.lowest && high < range.highest;
}

PLIANT_WIDE_VECTORS
void multiply_by_position(const i16* __restrict g, const i16* __restrict x, const i16* __restrict y,
                          int count, i16* __restrict by_x, i16* __restrict by_y) {
  const int n = count & ~15;
  for (int k = 0; k < n; ++k) {
    by_x[k] = narrow(narrow(x[k] * g[k]) >> 4);
    by_y[k] = narrow(narrow(y[k] * g[k]) >> 4);
  }
}

PLIANT_WIDE_VECTORS
Sums4 dot4(const i16* __restrict v, const i16* __restrict a, const i16* __restrict b, const i16* __restrict c,
           const i16* __restrict d, int count) {
  const int n = count & ~15;
  i32 va = 0, vb = 0, vc = 0, vd = 0;
  for (int k = 0; k < n; ++k) {
    va += i32{v[k]} * i32{a[k]};
    vb += i32{v[k]} * i32{b[k]};
    vc += i32{v[k]} * i32{c[k]};
    vd += i32{v[k]} * i32{d[k]};
  }
  return {va, vb, vc, vd};
}

PLIANT_WIDE_VECTORS
Sums10 products_of(const i16* __restrict a, const i16* __restrict b, const i16* __restrict c,
                   const i16* __restrict d, int count) {
  const int n = count & ~15;
  i32 aa = 0, ab = 0, ac = 0, ad = 0, bb = 0, bc = 0, bd = 0, cc = 0, cd = 0, dd = 0;
  for (int k = 0; k < n; ++k) {
    aa += i32{a[k]} * i32{a[k]};
    ab += i32{a[k]} * i32{b[k]};
    ac += i32{a[k]} * i32{c[k]};
    ad += i32{a[k]} * i32{d[k]};
    bb += i32{b[k]} * i32{b[k]};
    bc += i32{b[k]} * i32{c[k]};
    bd += i32{b[k]} * i32{d[k]};
    cc += i32{c[k]} * i32{c[k]};
    cd += i32{c[k]} * i32{d[k]};
    dd += i32{d[k]} * i32{d[k]};
  }
  return {aa, ab, ac, ad, bb, bc, bd, cc, cd, dd};
}

PLIANT_WIDE_VECTORS
i32 dot(const i16* __restrict v, const i16* __restrict a, int count) {
  const int n = count & ~15;
  i32 s = 0;
  for (int k = 0; k < n; ++k) s += i32{v[k]} * i32{a[k]};
  return s;
}

#endif

PLIANT_WIDE_VECTORS
int mask_extremes(const i16* __restrict image, const i16* __restrict m, int count, GreyRange range,
                  i16* __restrict out) {
  const i16 lo = range.lowest, hi = range.highest;
  const int n = count & ~15;
  i32 left = 0;
  for (int k = 0; k < n; ++k) {
    const i16 use = narrow(m[k] & (image[k] > lo) & (image[k] < hi));
    out[k] = use;
    left += i32{use} * i32{use};
  }
  return left;
}

PLIANT_WIDE_VECTORS
void apply_mask(const i16* __restrict in, const i16* __restrict m, int count, i16* __restrict out) {
  for (int k = 0; k < count; ++k) out[k] = narrow(in[k] * m[k]);
}

PLIANT_WIDE_VECTORS
i32 sum_squares(const i16* __restrict v, const i16* __restrict m, int count) {
  const int n = count & ~15;
  i32 s = 0;
  for (int k = 0; k < n; ++k) {
    const i16 used = narrow(v[k] * m[k]);
    s += i32{used} * i32{used};
  }
  return s;
}

}  // namespace pliant::patch
