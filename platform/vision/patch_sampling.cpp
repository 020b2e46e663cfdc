#include "vision/patch_sampling.hpp"

#include "base/wide_vectors.hpp"
#include "vision/cubic_phase.hpp"
#include "vision/patch_pairs.hpp"

// Two passes, across and down, go through `scratch` rather than from row to row, so that no vector is read right
// after its halves were written.
namespace pliant::patch {
namespace {

#if !PLIANT_HAS_HALFWORDS

template <int L>
void load_row(const std::uint8_t* __restrict p, i16* __restrict out) {
  for (int k = 0; k < L; ++k) out[k] = narrow(p[k] * kGreyScale - kGreyOffset);
}

template <int L, int S>
void load_rows(const std::uint8_t* pixels, std::ptrdiff_t stride, int count, i16* block) {
  for (int y = 0; y < count; ++y) load_row<L>(pixels + y * stride, block + y * S);
}

// --- bilinear: each product is t times 2^15 / 2^16, so that differences are doubled before or after ---

// To 1/64 grey: 4 * 2048 fits.
void linear_across(const i16* __restrict v, int count, i16 t, i16* __restrict out) {
  const int n = whole_vectors(count);
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

template <int L, int S>
void linear_rows(const i16* h, int window, i16 t, i16* out) {
  for (int y = 0; y < window; ++y) linear_down<L>(h + y * S, h + (y + 1) * S, t, out + y * window);
}

// --- on a lattice: scalar code fetches the four pixels of each sample as two pairs, vectors do the rest ---

// Pairs of neighbouring pixels: (x, x + 1) of the row above each sample, and of the row below it.
struct Pairs {
  u16 *upper, *lower;
};

void fetch_pairs(const std::uint8_t* pixels, std::ptrdiff_t stride, const Lattice& at, int window,
                 Pairs out) {
  const int columns = window + 2, row_length = block_stride(window);
  for (int j = 0; j < columns; ++j) {
    // As wide as addresses, so that no index is widened for each sample.
    std::ptrdiff_t x = at.x + j * at.down_x, y = at.y + j * at.down_y;
    u16 *u = out.upper + j * row_length, *l = out.lower + j * row_length;
    for (int i = 0; i < columns; ++i, x += at.across_x, y += at.across_y) {
      const std::uint8_t *p = pixels + (y >> kLatticeBits) * stride + (x >> kLatticeBits), *q = p + stride;
      u[i] = static_cast<u16>(p[0] | p[1] << 8);
      l[i] = static_cast<u16>(q[0] | q[1] << 8);
    }
  }
}

// Blends a pair, in 1/64 grey. t is a fraction times 2^15, less 2^15. It is never positive, because GCC would
// otherwise take it for an unsigned number and multiply in 32 bits.
inline i16 blend(u16 pair, i16 t) {
  const i16 first = narrow(pair & 255), second = narrow(pair >> 8);
  return narrow(64 * second + mulhi(narrow(128 * narrow(second - first)), t));
}

// Fractions of a pixel of a lattice position, in its lower fifteen bits; higher bits are ignored.
struct Fraction {
  i16 x, y;
};

// ramp_x and ramp_y are added to the fraction of the first sample of the row.
template <int S>
void blend_row(const u16* __restrict upper, const u16* __restrict lower, Fraction start,
               const i16* __restrict ramp_x, const i16* __restrict ramp_y, i16* __restrict out) {
  constexpr i32 kLess = -(1 << kLatticeBits);
  for (int k = 0; k < S; ++k) {
    const i16 tx = narrow(narrow(start.x + ramp_x[k]) | kLess),
              ty = narrow(narrow(start.y + ramp_y[k]) | kLess);
    const i16 h0 = blend(upper[k], tx), h1 = blend(lower[k], tx);
    const i16 v = narrow(h1 + 2 * mulhi(narrow(h1 - h0), ty));
    out[k] = narrow((narrow(v + 2) >> 2) - kGreyOffset);
  }
}

template <int S>
void blend_rows(Pairs pairs, const Lattice& at, int rows, i16* out) {
  const auto fraction = [](i32 v) { return narrow(v & ((1 << kLatticeBits) - 1)); };
  i16 ramp_x[S], ramp_y[S];
  for (int k = 0; k < S; ++k) {
    ramp_x[k] = fraction(k * at.across_x);
    ramp_y[k] = fraction(k * at.across_y);
  }
  for (int j = 0; j < rows; ++j)
    blend_row<S>(pairs.upper + j * S, pairs.lower + j * S,
                 {fraction(at.x + j * at.down_x), fraction(at.y + j * at.down_y)}, ramp_x, ramp_y,
                 out + j * S);
}

// --- cubic ---

// To 1/64 grey: with overshoot, 4 * 1.25 * 2048 fits. Without __restrict: with it, Clang keeps samples
// from one iteration to the next and does not vectorise the loop.
void cubic_across(const i16* v, int count, CubicPhase t, i16* out) {
  const int n = whole_vectors(count);
  for (int i = 0; i < n; ++i) {
    const i16 a = v[i], b = v[i + 1], c = v[i + 2], d = v[i + 3];
    const i16 s1 = narrow(narrow(a + c) - 2 * b), s2 = narrow(narrow(b + d) - 2 * c);
    const i16 line = narrow(4 * b + mulhi(narrow(8 * narrow(c - b)), t.line));
    const i16 curve = narrow(s1 + 2 * mulhi(narrow(s2 - s1), t.blend));
    out[i] = narrow(line - mulhi(narrow(2 * curve), t.bend));
  }
}

// Back to 1/16 grey. Curvature is taken from values of 1/16 grey, which keeps its differences within 16 bits.
// Overshoot is cut off, because it would exceed the bounds of the sums.
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

#endif

}  // namespace

#if PLIANT_HAS_HALFWORDS

void load_block(const std::uint8_t* pixels, std::ptrdiff_t stride, int window, i16* block) {
  pairs::load_rows(pixels, stride, block_rows(window), block_stride(window), block);
}

void sample_linear(const i16* block, int fx, int fy, int window, i16* scratch, i16* out) {
  pairs::sample_linear(block, fx, fy, window, scratch, out);
}

void sample_cubic(const i16* block, int fx, int fy, int window, i16* scratch, i16* out) {
  pairs::sample_cubic(block, fx, fy, window, scratch, out);
}

void sample_lattice(const std::uint8_t* pixels, int stride, const Lattice& at, int window, i16*, i16* block) {
  pairs::sample_lattice(pixels, stride, at, window, block);
}

#else

PLIANT_WIDE_VECTORS
void load_block(const std::uint8_t* pixels, std::ptrdiff_t stride, int window, i16* block) {
  PLIANT_ASSERT(is_window(window) && pixels != nullptr);
  const int count = block_rows(window);
  if (block_stride(window) == 16) return load_rows<16, 16>(pixels, stride, count, block);
  load_rows<16, 24>(pixels, stride, count, block);
  load_rows<8, 24>(pixels + 16, stride, count, block + 16);
}

PLIANT_WIDE_VECTORS
void sample_linear(const i16* block, int fx, int fy, int window, i16* scratch, i16* out) {
  PLIANT_ASSERT(fx >= 0 && fx < kSubpixel && fy >= 0 && fy < kSubpixel);
  const int stride = block_stride(window);
  linear_across(block + stride + 1, (window + 1) * stride, narrow(fx * 256), scratch);
  with_sizes(window,
             [&](auto s) { linear_rows<s.kLanes, s.kStride>(scratch, window, narrow(fy * 256), out); });
}

PLIANT_WIDE_VECTORS
void sample_cubic(const i16* block, int fx, int fy, int window, i16* scratch, i16* out) {
  PLIANT_ASSERT(fx >= 0 && fx < kSubpixel && fy >= 0 && fy < kSubpixel);
  cubic_across(block, (window + 3) * block_stride(window), cubic_phase(fx), scratch);
  const CubicPhase t = cubic_phase(fy);
  with_sizes(window, [&](auto s) { cubic_rows<s.kLanes, s.kStride>(scratch, window, t, out); });
}

void sample_lattice(const std::uint8_t* pixels, int stride, const Lattice& at, int window, i16* scratch,
                    i16* block) {
  u16* const upper = reinterpret_cast<u16*>(scratch);
  const Pairs pairs{upper, upper + block_size(window)};
  fetch_pairs(pixels, stride, at, window, pairs);
  with_sizes(window, [&](auto s) { blend_rows<s.kStride>(pairs, at, window + 2, block); });
}

#endif

}  // namespace pliant::patch
