// A template's grey levels and gradients from a block. The gradient is Scharr's: a central difference one way, smoothed by
// 3, 10, 3 the other way.
#include <cstring>

#include "base/wide_vectors.hpp"
#include "vision/patch_pairs.hpp"
#include "vision/patch_template.hpp"

namespace pliant::patch {

#if PLIANT_HAS_HALFWORDS

void make_template(const i16* block, const i16* mask, int window, i16* scratch, Template out) {
  const int stride = block_stride(window);
  i16 *down = scratch, *across = scratch + block_size(window);
  pairs::smooth3(block, stride, window * stride, down);
  pairs::smooth3(block, 1, (window + 2) * stride, across);
  const int count = pairs::columns(window);
  for (int k = 0; k < window * window; k += window) {
    pairs::mask_row(block + stride + 1, mask + k, count, out.t + k, out.m + k);
    pairs::gradient_row(down, down + 2, out.m + k, count, out.gx + k);
    pairs::gradient_row(across, across + 2 * stride, out.m + k, count, out.gy + k);
    block += stride;
    down += stride;
    across += stride;
  }
}

#else

namespace {

// Half of (3 a + 10 b + 3 c), where b is one `step` on and c two. |3 + 10 + 3| * 2048 = 2^15 at most, just within.
PLIANT_WIDE_VECTORS
void smooth3(const i16* __restrict in, int step, int count, i16* __restrict out) {
  const i16* __restrict b = in + step, * __restrict c = in + 2 * step;
  const int n = whole_vectors(count);
  for (int i = 0; i < n; ++i)
    out[i] = narrow(narrow(narrow(3 * narrow(in[i] + c[i])) + narrow(10 * b[i])) >> 1);
}

// A sixteenth of the difference.
template <int L>
void subtract_row(const i16* __restrict before, const i16* __restrict after, i16* __restrict out) {
  for (int k = 0; k < L; ++k) out[k] = narrow(narrow(after[k] - before[k]) >> 4);
}

template <int L, int S>
void subtract_rows(const i16* smooth, int step, int window, i16* out) {
  for (int y = 0; y < window; ++y) subtract_row<L>(smooth + y * S, smooth + y * S + step, out + y * window);
}

// Differences of smoothed elements that are `step` apart, in the rows of a window.
PLIANT_WIDE_VECTORS
void subtract(const i16* smooth, int step, int window, i16* out) {
  with_sizes(window, [&](auto s) { subtract_rows<s.kLanes, s.kStride>(smooth, step, window, out); });
}

// From the rows of a block to those of a window.
PLIANT_WIDE_VECTORS
void copy_rows(const i16* block, int window, i16* out) {
  with_sizes(window, [&](auto s) {
    for (int y = 0; y < window; ++y)
      std::memcpy(out + y * window, block + y * s.kStride, s.kLanes * sizeof(i16));
  });
}

// Leaves out what the mask leaves out, and clipped pixels.
PLIANT_WIDE_VECTORS
void mask_template(const i16* __restrict mask, int count, i16* __restrict t, i16* __restrict gx,
                   i16* __restrict gy, i16* __restrict m) {
  constexpr GreyRange r = kUsableGrey;
  const int n = count & ~15;
  for (int k = 0; k < n; ++k) {
    const i16 use = narrow(mask[k] & (t[k] > r.lowest) & (t[k] < r.highest));
    m[k] = use;
    t[k] = narrow(t[k] * use);
    gx[k] = narrow(gx[k] * use);
    gy[k] = narrow(gy[k] * use);
  }
}

}  // namespace

// Not for wide vectors as a whole: where its parts are inlined, GCC loses their __restrict and makes fewer vectors.
void make_template(const i16* block, const i16* mask, int window, i16* scratch, Template out) {
  const int stride = block_stride(window);
  smooth3(block, stride, window * stride, scratch);
  subtract(scratch, 2, window, out.gx);
  smooth3(block, 1, (window + 2) * stride, scratch);
  subtract(scratch, 2 * stride, window, out.gy);
  copy_rows(block + stride + 1, window, out.t);
  mask_template(mask, padded(window), out.t, out.gx, out.gy, out.m);
}

#endif

}  // namespace pliant::patch
