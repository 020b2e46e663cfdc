// See patch_kernels.hpp. Two rules make compilers vectorise these: the loops are flat, over whole arrays, and
// every intermediate value is cast back to 16 bits, where it is known to fit. Passes go through `scratch`
// rather than from row to row, so that no vector is read right after its halves were written.
#include "vision/patch_kernels.hpp"

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

template <int L, int S>
struct Sizes {
  static constexpr int kLanes = L, kStride = S;
};

// Whole vectors: what is computed too much lies in the slack of the arrays.
constexpr int whole(int count) {
  return (count + 15) & ~15;
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
__attribute__((noinline)) void linear_down(const i16* __restrict h0, const i16* __restrict h1, i16 t,
                                           i16* __restrict out) {
  for (int k = 0; k < L; ++k) {
    const i16 v = narrow(h0[k] + 2 * mulhi(narrow(h1[k] - h0[k]), t));
    out[k] = narrow(narrow(v + 2) >> 2);
  }
}

template <int L, int S>
void linear_rows(const i16* h, int window, i16 t, i16* out) {
  for (int y = 0; y < window; ++y) linear_down<L>(h + y * S, h + (y + 1) * S, t, out + y * window);
}

// --- on a lattice: scalar code fetches the four pixels of each sample, as two pairs; vectors do the rest ---

using u16 = std::uint16_t;

void fetch_pairs(const std::uint8_t* pixels, std::ptrdiff_t stride, const Lattice& at, int columns,
                 int row_length, u16* __restrict upper, u16* __restrict lower) {
  for (int j = 0; j < columns; ++j) {
    // As wide as addresses, so that nothing need be widened for each sample.
    std::ptrdiff_t x = at.x + j * at.down_x, y = at.y + j * at.down_y;
    u16 *u = upper + j * row_length, *l = lower + j * row_length;
    for (int i = 0; i < columns; ++i, x += at.across_x, y += at.across_y) {
      const std::uint8_t *p = pixels + (y >> kLatticeBits) * stride + (x >> kLatticeBits), *q = p + stride;
      u[i] = static_cast<u16>(p[0] | p[1] << 8);
      l[i] = static_cast<u16>(q[0] | q[1] << 8);
    }
  }
}

// A pair blended, in 1/64 grey; t is a fraction times 2^15, less 2^15: it is never positive, which keeps GCC from taking
// it for an unsigned number and multiplying in 32 bits.
inline i16 blend(u16 pair, i16 t) {
  const i16 first = narrow(pair & 255), second = narrow(pair >> 8);
  return narrow(64 * second + mulhi(narrow(128 * narrow(second - first)), t));
}

// Fractions of positions are their lower fifteen bits, whatever runs over: those of a row's start and, in the ramps, what
// is added along it.
template <int S>
void blend_row(const u16* __restrict upper, const u16* __restrict lower, i16 x, i16 y,
               const i16* __restrict ramp_x, const i16* __restrict ramp_y, i16* __restrict out) {
  constexpr i32 kLess = -(1 << kLatticeBits);
  for (int k = 0; k < S; ++k) {
    const i16 tx = narrow(narrow(x + ramp_x[k]) | kLess), ty = narrow(narrow(y + ramp_y[k]) | kLess);
    const i16 h0 = blend(upper[k], tx), h1 = blend(lower[k], tx);
    const i16 v = narrow(h1 + 2 * mulhi(narrow(h1 - h0), ty));
    out[k] = narrow((narrow(v + 2) >> 2) - kGreyOffset);
  }
}

template <int S>
void blend_rows(const u16* upper, const u16* lower, const Lattice& at, int rows, i16* out) {
  const auto fraction = [](i32 v) { return narrow(v & ((1 << kLatticeBits) - 1)); };
  i16 ramp_x[S], ramp_y[S];
  for (int k = 0; k < S; ++k) {
    ramp_x[k] = fraction(k * at.across_x);
    ramp_y[k] = fraction(k * at.across_y);
  }
  for (int j = 0; j < rows; ++j)
    blend_row<S>(upper + j * S, lower + j * S, fraction(at.x + j * at.down_x), fraction(at.y + j * at.down_y),
                 ramp_x, ramp_y, out + j * S);
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
template <int L, int S>
void cubic_down(const i16* __restrict h, CubicPhase t, i16* __restrict out) {
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

template <int L, int S>
void cubic_rows(const i16* h, int window, CubicPhase t, i16* out) {
  for (int y = 0; y < window; ++y) cubic_down<L, S>(h + y * S, t, out + y * window);
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

template <int L, int S>
void template_rows(const i16* block, const i16* down, const i16* across, const i16* mask, int window,
                   i16 lowest, i16 highest, Template out) {
  for (int y = 0, k = 0; y < window; ++y, k += window)
    template_row<L>(block + (y + 1) * S + 1, down + y * S, across + y * S, across + (y + 2) * S, mask + k,
                    lowest, highest, out.t + k, out.gx + k, out.gy + k, out.m + k);
}

// Calls f with the lanes and the block's stride of a window as constants.
template <class F>
void with_sizes(int window, F&& f) {
  const int l = lanes(window);
  if (l == 8) f(Sizes<8, 16>{});
  if (l == 16 && block_stride(window) == 16) f(Sizes<16, 16>{});
  if (l == 16 && block_stride(window) == 24) f(Sizes<16, 24>{});
  if (l == 24) f(Sizes<24, 24>{});
}

}  // namespace

void load_block(const std::uint8_t* pixels, std::ptrdiff_t stride, int window, i16* block) {
  const int count = block_rows(window);
  if (block_stride(window) == 16) load_rows<16>(pixels, stride, count, block);
  if (block_stride(window) == 24) load_rows<24>(pixels, stride, count, block);
}

void sample_linear(const i16* block, int fx, int fy, int window, i16* scratch, i16* out) {
  const int stride = block_stride(window);
  linear_across(block + stride + 1, (window + 1) * stride, narrow(fx * 256), scratch);
  with_sizes(window,
             [&](auto s) { linear_rows<s.kLanes, s.kStride>(scratch, window, narrow(fy * 256), out); });
}

void sample_lattice(const std::uint8_t* pixels, int stride, const Lattice& at, int window, i16* scratch,
                    i16* block) {
  const int rows = window + 2, row_length = block_stride(window);
  u16 *upper = reinterpret_cast<u16*>(scratch), *lower = upper + block_size(window);
  fetch_pairs(pixels, stride, at, rows, row_length, upper, lower);
  with_sizes(window, [&](auto s) { blend_rows<s.kStride>(upper, lower, at, rows, block); });
}

void sample_cubic(const i16* block, int fx, int fy, int window, i16* scratch, i16* out) {
  cubic_across(block, (window + 3) * block_stride(window), cubic_phase(fx), scratch);
  const CubicPhase t = cubic_phase(fy);
  with_sizes(window, [&](auto s) { cubic_rows<s.kLanes, s.kStride>(scratch, window, t, out); });
}

void make_template(const i16* block, const i16* mask, int window, int lowest, int highest, i16* scratch,
                   Template out) {
  const int stride = block_stride(window);
  i16 *down = scratch, *across = scratch + block_size(window);
  smooth3(block, stride, window * stride, down);
  smooth3(block, 1, (window + 2) * stride, across);
  const i16 lo = narrow(lowest), hi = narrow(highest);
  with_sizes(window, [&](auto s) {
    template_rows<s.kLanes, s.kStride>(block, down, across, mask, window, lo, hi, out);
  });
}

bool is_within(const i16* __restrict v, int count, int lowest, int highest) {
  const int n = count & ~15;
  i16 low = narrow(highest), high = narrow(lowest);
  for (int k = 0; k < n; ++k) {
    low = v[k] < low ? v[k] : low;
    high = v[k] > high ? v[k] : high;
  }
  return low > lowest && high < highest;
}

int mask_extremes(const i16* __restrict image, const i16* __restrict m, int count, int lowest, int highest,
                  i16* __restrict out) {
  const i16 lo = narrow(lowest), hi = narrow(highest);
  const int n = count & ~15;
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

void multiply_by_position(const i16* __restrict g, const i16* __restrict x, const i16* __restrict y,
                          int count, i16* __restrict by_x, i16* __restrict by_y) {
  const int n = count & ~15;
  for (int k = 0; k < n; ++k) {
    by_x[k] = narrow(narrow(x[k] * g[k]) >> 4);
    by_y[k] = narrow(narrow(y[k] * g[k]) >> 4);
  }
}

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

i32 dot(const i16* __restrict v, const i16* __restrict a, int count) {
  const int n = count & ~15;
  i32 s = 0;
  for (int k = 0; k < n; ++k) s += i32{v[k]} * i32{a[k]};
  return s;
}

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
