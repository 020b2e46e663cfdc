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

// --- bilinear ---

// Rows interpolated across, 1/128 grey: 255 * 128 fits 15 bits.
template <int L>
void linear_across(Pixels in, int rows, i16 fx, i16* __restrict out) {
  for (int y = 0; y < rows; ++y, out += L) {
    const std::uint8_t* __restrict p = in.data + y * in.stride;
    for (int k = 0; k < L; ++k) out[k] = narrow(p[k] * kSubpixel + narrow(p[k + 1] - p[k]) * fx);
  }
}

// Row i and the next one, interpolated down. `fy` is the phase times 256: the upper half of the product is
// half of the step wanted, and everything is in 1/64 grey until the rounding at the end.
void linear_down(const i16* __restrict rows, int stride, int count, i16 fy, i16* __restrict out) {
  const i16* __restrict next = rows + stride;
  for (int i = 0; i < count; ++i) {
    const i16 half = narrow((rows[i] >> 1) + mulhi(narrow(next[i] - rows[i]), fy));
    out[i] = narrow((narrow(half + 2) >> 2) - kGreyOffset);
  }
}

// --- cubic ---

// Catmull and Rom's cubic as the line between the two middle samples plus a bend:
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

// Rows interpolated across, (grey - 128) * 64: overshoot included, 128 * 1.25 * 64 fits 15 bits.
template <int L>
void cubic_across(Pixels in, int rows, CubicPhase t, i16* __restrict out) {
  for (int y = 0; y < rows; ++y, out += L) {
    const std::uint8_t* __restrict p = in.data + y * in.stride - 1;
    for (int k = 0; k < L; ++k) {
      const i16 step = narrow(p[k + 2] - p[k + 1]);
      const i16 s1 = narrow(narrow(p[k] + p[k + 2]) - 2 * p[k + 1]),
                s2 = narrow(narrow(p[k + 1] + p[k + 3]) - 2 * p[k + 2]);
      const i16 line = narrow(narrow(p[k + 1] * 64 - 128 * 64) + mulhi(narrow(step * 128), t.line));
      const i16 curve =
          narrow(narrow(s1 * 32) + 2 * mulhi(narrow(narrow(s2 - s1) * 32), t.blend));  // times 32
      out[k] = narrow(line - mulhi(curve, t.bend));
    }
  }
}

// Rows 0 to 3 rows on, interpolated down, to 1/16 grey. Curvature is taken from values of 1/16 grey, which
// keeps its differences within 16 bits. Overshoot is cut off: it would not fit the bounds of the sums.
void cubic_down(const i16* __restrict h, int stride, int count, CubicPhase t, i16* __restrict out) {
  const i16* __restrict h1 = h + stride, * __restrict h2 = h + 2 * stride, * __restrict h3 = h + 3 * stride;
  for (int i = 0; i < count; ++i) {
    const i16 g0 = narrow(h[i] >> 2), g1 = narrow(h1[i] >> 2), g2 = narrow(h2[i] >> 2),
              g3 = narrow(h3[i] >> 2);
    const i16 s1 = narrow(narrow(g0 + g2) - 2 * g1), s2 = narrow(narrow(g1 + g3) - 2 * g2);
    const i16 line = narrow(h1[i] + 2 * mulhi(narrow(h2[i] - h1[i]), t.line));
    const i16 curve = narrow(s1 + 2 * mulhi(narrow(s2 - s1), t.blend));
    const i16 v = narrow((narrow(line + 2) >> 2) - narrow(mulhi(curve, t.bend) >> 1));
    const i16 low = v < -kGreyOffset ? narrow(-kGreyOffset) : v;
    out[i] = low > kGreyOffset - 1 ? narrow(kGreyOffset - 1) : low;
  }
}

template <int L>
void load_rows(Pixels in, int window, i16* __restrict block) {
  for (int y = 0; y < window + 2; ++y, block += L + 8) {
    const std::uint8_t* __restrict p = in.data + y * in.stride;
    for (int k = 0; k < L + 8; ++k) block[k] = narrow(p[k] * kGreyScale - kGreyOffset);
  }
}

// Half of (3 a + 10 b + 3 c), where b is one and c two `step`s on. |3 + 10 + 3| * 2048 = 2^15 at most, just
// within.
void smooth3(const i16* __restrict in, int step, int count, i16* __restrict out) {
  const i16* __restrict b = in + step, * __restrict c = in + 2 * step;
  for (int i = 0; i < count; ++i)
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

void sample_linear(Pixels in, int fx, int fy, int window, i16* scratch, i16* out) {
  const int l = lanes(window);
  if (l == 8) linear_across<8>(in, window + 1, narrow(fx), scratch);
  if (l == 16) linear_across<16>(in, window + 1, narrow(fx), scratch);
  if (l == 24) linear_across<24>(in, window + 1, narrow(fx), scratch);
  linear_down(scratch, l, window * l, narrow(fy * 256), out);
}

void sample_cubic(Pixels in, int fx, int fy, int window, i16* scratch, i16* out) {
  const int l = lanes(window);
  in.data -= in.stride;
  if (l == 8) cubic_across<8>(in, window + 3, cubic_phase(fx), scratch);
  if (l == 16) cubic_across<16>(in, window + 3, cubic_phase(fx), scratch);
  if (l == 24) cubic_across<24>(in, window + 3, cubic_phase(fx), scratch);
  cubic_down(scratch, l, window * l, cubic_phase(fy), out);
}

void load_block(Pixels in, int window, i16* block) {
  if (lanes(window) == 8) load_rows<8>(in, window, block);
  if (lanes(window) == 16) load_rows<16>(in, window, block);
  if (lanes(window) == 24) load_rows<24>(in, window, block);
}

void make_template(const i16* block, const i16* mask, int window, int lowest, int highest, i16* scratch,
                   Template out) {
  const int l = lanes(window), stride = block_stride(window), rows = window + 2;
  i16 *down = scratch, *across = scratch + block_size(window);
  smooth3(block, stride, window * stride, down);
  smooth3(block, 1, rows * stride - 2, across);
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
