// A template's grey levels and gradients from a block. The gradient is Scharr's: a central difference one way, smoothed by
// 3, 10, 3 the other way.
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

// These two are not inlined: in the caller GCC forgets that nothing overlaps and finds no vectors.
template <int L>
[[gnu::noinline]] void mask_row(const i16* __restrict v, const i16* __restrict mask, i16* __restrict t,
                                i16* __restrict m) {
  constexpr GreyRange r = kUsableGrey;
  for (int k = 0; k < L; ++k) {
    const i16 use = narrow(mask[k] & (v[k] > r.lowest) & (v[k] < r.highest));
    m[k] = use;
    t[k] = narrow(v[k] * use);
  }
}

// The difference of two smoothed neighbours, where m is 1.
template <int L>
[[gnu::noinline]] void gradient_row(const i16* __restrict before, const i16* __restrict after,
                                    const i16* __restrict m, i16* __restrict out) {
  for (int k = 0; k < L; ++k) out[k] = narrow(narrow(narrow(after[k] - before[k]) >> 4) * m[k]);
}

// `down` is the block smoothed along columns, stored one row higher. `across` is the block smoothed along rows, stored one
// column further left.
template <int L, int S>
void template_rows(const i16* block, const i16* down, const i16* across, const i16* mask, int window,
                   Template out) {
  for (int y = 0, k = 0; y < window; ++y, k += window) {
    mask_row<L>(block + (y + 1) * S + 1, mask + k, out.t + k, out.m + k);
    gradient_row<L>(down + y * S, down + y * S + 2, out.m + k, out.gx + k);
    gradient_row<L>(across + y * S, across + (y + 2) * S, out.m + k, out.gy + k);
  }
}

}  // namespace

// Not for wide vectors, since it calls functions that are not inlined.
void make_template(const i16* block, const i16* mask, int window, i16* scratch, Template out) {
  const int stride = block_stride(window);
  i16 *down = scratch, *across = scratch + block_size(window);
  smooth3(block, stride, window * stride, down);
  smooth3(block, 1, (window + 2) * stride, across);
  with_sizes(window,
             [&](auto s) { template_rows<s.kLanes, s.kStride>(block, down, across, mask, window, out); });
}

#endif

}  // namespace pliant::patch
