// See patch_kernels.hpp. Two rules make compilers vectorise these: the loops are flat, over whole arrays, and
// every intermediate value is cast back to 16 bits, where it is known to fit. Passes go through `scratch`
// rather than from row to row, so that no vector is read right after its halves were written.
#include "patch_kernels.hpp"

namespace pliant::patch {
namespace {

using i16 = std::int16_t;
using i32 = std::int32_t;

constexpr i16 narrow(i32 v) {
  return static_cast<i16>(v);
}
// Upper half of a 32-bit product.
constexpr i16 mulhi(i16 a, i16 b) {
  return narrow((i32{a} * b) >> 16);
}

// Whole vectors: what is computed too much lies in the slack of the arrays.
constexpr int whole(int count) {
  return (count + 31) & ~31;
}

template <int S>
void load_row(const std::uint8_t* __restrict p, i16* __restrict out) {
  for (int k = 0; k < S; ++k) out[k] = narrow(p[k] * kGreyScale - kGreyOffset);
}

template <int S>
void load_rows(const std::uint8_t* pixels, std::ptrdiff_t stride, int count, i16* block) {
  for (int y = 0; y < count; ++y) load_row<S>(pixels + y * stride, block + y * S);
}

// --- bilinear: each step's product is taken times 2^15 / 2^16, so differences are doubled before or after
// ---

// To 1/64 grey: 4 * 2048 fits.
void linear_across(const i16* __restrict v, int count, i16 t, i16* __restrict out) {
  const int n = whole(count);
  for (int i = 0; i < n; ++i) out[i] = narrow(4 * v[i] + mulhi(narrow(8 * narrow(v[i + 1] - v[i])), t));
}

// Back to 1/16 grey.
template <int L>
void linear_down(const i16* __restrict h0, const i16* __restrict h1, i16 t, i16* __restrict out) {
  for (int k = 0; k < L; ++k) {
    const i16 v = narrow(h0[k] + 2 * mulhi(narrow(h1[k] - h0[k]), t));
    out[k] = narrow(narrow(v + 2) >> 2);
  }
}

template <int L>
void linear_rows(const i16* h, int window, i16 t, i16* out) {
  constexpr int S = L + 8;
  for (int y = 0; y < window; ++y) linear_down<L>(h + y * S, h + (y + 1) * S, t, out + y * L);
}

// --- cubic ---

// Catmull and Rom's cubic as the line between the two middle samples less a bend:
//   p1 + t (p2 - p1) - t (1 - t) / 2 [(1 - t) (p0 - 2 p1 + p2) + t (p1 - 2 p2 + p3)].
// Its remaining phase error is of the form t (1 - t) (1 - 2 t); moving t by a twentieth of that halves the
// position error that is left on textures with wavelengths of five pixels and more.
struct CubicPhase {
  i16 line, blend;  // the two uses of t, times 2^15
  i16 bend;         // t (1 - t) times 2^16, at most 2^14
};

CubicPhase cubic_phase(int f) {
  const int p = f * (kSubpixel - f);             // t (1 - t) * 2^14
  const int odd = p * (kSubpixel - 2 * f) / 20;  // t (1 - t) (1 - 2 t) / 20 * 2^21
  return {narrow(f * 256 + odd / 64), narrow(f * 256), narrow(p * 4)};
}

// To 1/64 grey: overshoot included, 4 * 1.25 * 2048 fits. Without __restrict: told that nothing overlaps,
// Clang keeps samples from one turn to the next and then finds no vectors.
void cubic_across(const i16* v, int count, CubicPhase t, i16* out) {
  const int n = whole(count);
  for (int i = 0; i < n; ++i) {
    const i16 a = v[i], b = v[i + 1], c = v[i + 2], d = v[i + 3];
    const i16 s1 = narrow(narrow(a + c) - 2 * b), s2 = narrow(narrow(b + d) - 2 * c);
    const i16 line = narrow(4 * b + mulhi(narrow(8 * narrow(c - b)), t.line));
    const i16 curve = narrow(s1 + 2 * mulhi(narrow(s2 - s1), t.blend));
    out[i] = narrow(line - mulhi(narrow(2 * curve), t.bend));
  }
}

// Back to 1/16 grey. Curvature is taken from values of 1/16 grey, which keeps its differences within 16 bits.
// Overshoot is cut off: it would not fit the bounds of the sums.
template <int L>
void cubic_down(const i16* __restrict h, CubicPhase t, i16* __restrict out) {
  constexpr int S = L + 8;
  for (int k = 0; k < L; ++k) {
    const i16 h1 = h[k + S], h2 = h[k + 2 * S];
    const i16 a = narrow(h[k] >> 2), b = narrow(h1 >> 2), c = narrow(h2 >> 2), d = narrow(h[k + 3 * S] >> 2);
    const i16 s1 = narrow(narrow(a + c) - 2 * b), s2 = narrow(narrow(b + d) - 2 * c);
    const i16 line = narrow(h1 + 2 * mulhi(narrow(h2 - h1), t.line));
    const i16 curve = narrow(s1 + 2 * mulhi(narrow(s2 - s1), t.blend));
    const i16 v = narrow((narrow(line + 2) >> 2) - narrow(mulhi(curve, t.bend) >> 1));
    const i16 low = v < -kGreyOffset ? narrow(-kGreyOffset) : v;
    out[k] = low > kGreyOffset - 1 ? narrow(kGreyOffset - 1) : low;
  }
}

template <int L>
void cubic_rows(const i16* h, int window, CubicPhase t, i16* out) {
  for (int y = 0; y < window; ++y) cubic_down<L>(h + y * (L + 8), t, out + y * L);
}

// --- templates ---

// Half of (3 a + 10 b + 3 c), where b is one and c two `step`s on. |3 + 10 + 3| * 2048 = 2^15 at most, just
// within.
void smooth3(const i16* __restrict in, int step, int count, i16* __restrict out) {
  const i16* __restrict b = in + step, * __restrict c = in + 2 * step;
  const int n = whole(count);
  for (int i = 0; i < n; ++i)
    out[i] = narrow(narrow(narrow(3 * narrow(in[i] + c[i])) + narrow(10 * b[i])) >> 1);
}

// One row: `v` the pixels, `down` and `across` their smoothed neighbours from one pixel up and left.
template <int L>
void template_row(const i16* __restrict v, const i16* __restrict down, const i16* __restrict upper,
                  const i16* __restrict lower, const i16* __restrict mask, i16 lowest, i16 highest,
                  i16* __restrict t, i16* __restrict gx, i16* __restrict gy, i16* __restrict m) {
  for (int k = 0; k < L; ++k) {
    const i16 use = narrow(mask[k] & (v[k] > lowest) & (v[k] < highest));
    m[k] = use;
    t[k] = narrow(v[k] * use);
    gx[k] = narrow(narrow(narrow(down[k + 2] - down[k]) >> 4) * use);
    gy[k] = narrow(narrow(narrow(lower[k] - upper[k]) >> 4) * use);
  }
}

template <int L>
void template_rows(const i16* block, const i16* down, const i16* across, const i16* mask, int window,
                   i16 lowest, i16 highest, Template out) {
  constexpr int S = L + 8;
  for (int y = 0; y < window; ++y)
    template_row<L>(block + (y + 1) * S + 1, down + y * S, across + y * S, across + (y + 2) * S, mask + y * L,
                    lowest, highest, out.t + y * L, out.gx + y * L, out.gy + y * L, out.m + y * L);
}

template <int L>
void position_row(const i16* __restrict g, i16 half, i16 dy, i16* __restrict by_x, i16* __restrict by_y) {
  for (int k = 0; k < L; ++k) {
    by_x[k] = narrow(narrow(narrow(k - half) * g[k]) >> 4);
    by_y[k] = narrow(narrow(dy * g[k]) >> 4);
  }
}

template <int L>
void position_rows(const i16* g, int window, i16* by_x, i16* by_y) {
  const int half = window / 2;
  for (int y = 0; y < window; ++y)
    position_row<L>(g + y * L, narrow(half), narrow(y - half), by_x + y * L, by_y + y * L);
}

}  // namespace

void load_block(const std::uint8_t* pixels, std::ptrdiff_t stride, int window, i16* block) {
  const int l = lanes(window), count = block_rows(window);
  if (l == 8) load_rows<16>(pixels, stride, count, block);
  if (l == 16) load_rows<24>(pixels, stride, count, block);
  if (l == 24) load_rows<32>(pixels, stride, count, block);
}

void sample_linear(const i16* block, int fx, int fy, int window, i16* scratch, i16* out) {
  const int l = lanes(window), stride = block_stride(window);
  linear_across(block + stride + 1, (window + 1) * stride, narrow(fx * 256), scratch);
  const i16 t = narrow(fy * 256);
  if (l == 8) linear_rows<8>(scratch, window, t, out);
  if (l == 16) linear_rows<16>(scratch, window, t, out);
  if (l == 24) linear_rows<24>(scratch, window, t, out);
}

void sample_cubic(const i16* block, int fx, int fy, int window, i16* scratch, i16* out) {
  const int l = lanes(window), stride = block_stride(window);
  cubic_across(block, (window + 3) * stride, cubic_phase(fx), scratch);
  const CubicPhase t = cubic_phase(fy);
  if (l == 8) cubic_rows<8>(scratch, window, t, out);
  if (l == 16) cubic_rows<16>(scratch, window, t, out);
  if (l == 24) cubic_rows<24>(scratch, window, t, out);
}

void make_template(const i16* block, const i16* mask, int window, int lowest, int highest, i16* scratch,
                   Template out) {
  const int l = lanes(window), stride = block_stride(window);
  i16 *down = scratch, *across = scratch + block_size(window);
  smooth3(block, stride, window * stride, down);
  smooth3(block, 1, (window + 2) * stride, across);
  const i16 lo = narrow(lowest), hi = narrow(highest);
  if (l == 8) template_rows<8>(block, down, across, mask, window, lo, hi, out);
  if (l == 16) template_rows<16>(block, down, across, mask, window, lo, hi, out);
  if (l == 24) template_rows<24>(block, down, across, mask, window, lo, hi, out);
}

int mask_extremes(const i16* __restrict image, const i16* __restrict m, int count, int lowest, int highest,
                  i16* __restrict out) {
  const i16 lo = narrow(lowest), hi = narrow(highest);
  const int n = count & ~31;
  i32 left = 0;
  for (int k = 0; k < n; ++k) {
    const i16 use = narrow(m[k] & (image[k] > lo) & (image[k] < hi));
    out[k] = use;
    left += i32{use} * i32{use};
  }
  return left;
}

void apply_mask(const i16* __restrict in, const i16* __restrict m, int count, i16* __restrict out) {
  for (int k = 0; k < count; ++k) out[k] = narrow(in[k] * m[k]);
}

void multiply_by_position(const i16* g, int window, i16* by_x, i16* by_y) {
  if (lanes(window) == 8) position_rows<8>(g, window, by_x, by_y);
  if (lanes(window) == 16) position_rows<16>(g, window, by_x, by_y);
  if (lanes(window) == 24) position_rows<24>(g, window, by_x, by_y);
}

Sums4 dot4(const i16* __restrict v, const i16* __restrict a, const i16* __restrict b, const i16* __restrict c,
           const i16* __restrict d, int count) {
  const int n = count & ~31;
  i32 va = 0, vb = 0, vc = 0, vd = 0;
  for (int k = 0; k < n; ++k) {
    va += i32{v[k]} * i32{a[k]};
    vb += i32{v[k]} * i32{b[k]};
    vc += i32{v[k]} * i32{c[k]};
    vd += i32{v[k]} * i32{d[k]};
  }
  return {va, vb, vc, vd};
}

i32 dot(const i16* __restrict v, const i16* __restrict a, int count) {
  const int n = count & ~31;
  i32 s = 0;
  for (int k = 0; k < n; ++k) s += i32{v[k]} * i32{a[k]};
  return s;
}

i32 sum_squares(const i16* __restrict v, const i16* __restrict m, int count) {
  const int n = count & ~31;
  i32 s = 0;
  for (int k = 0; k < n; ++k) {
    const i16 used = narrow(v[k] * m[k]);
    s += i32{used} * i32{used};
  }
  return s;
}

}  // namespace pliant::patch
