// See patch_kernels.hpp. The row length is a template parameter (8, 16 or 24 lanes for windows of 7 to 21),
// which is all that a compiler needs to unroll a row into whole vectors.
#include "patch_kernels.hpp"

namespace pliant::patch {
namespace {

using i16 = std::int16_t;
using i32 = std::int32_t;

// One row, interpolated across: 255 * 128 fits 15 bits.
template <int L>
void interpolate_across(const std::uint8_t* __restrict p, i16 fx, i16* __restrict out) {
  for (int k = 0; k < L; ++k) out[k] = static_cast<i16>(p[k] * kSubpixel + (p[k + 1] - p[k]) * fx);
}

// Two rows, interpolated down, to 1/16 grey. `fy` is the phase times 256, so that the product's upper half is
// half of the difference wanted; sums of 14 bits with rounding at the end.
template <int L>
void interpolate_down(const i16* __restrict upper, const i16* __restrict lower, i16 fy, i16* __restrict out) {
  for (int k = 0; k < L; ++k) {
    const auto step = static_cast<i16>((static_cast<i32>(static_cast<i16>(lower[k] - upper[k])) * fy) >> 16);
    const auto half = static_cast<i16>((upper[k] >> 1) + step);  // 1/64 grey
    out[k] = static_cast<i16>(((half + 2) >> 2) - kGreyOffset);
  }
}

template <int L>
void sample_rows(Pixels in, int fx, int fy, int window, i16* __restrict out) {
  alignas(32) i16 line[2][L];
  interpolate_across<L>(in.data, static_cast<i16>(fx), line[0]);
  for (int y = 0; y < window; ++y, out += L) {
    const i16* upper = line[y & 1];
    i16* lower = line[(y + 1) & 1];
    interpolate_across<L>(in.data + (y + 1) * in.stride, static_cast<i16>(fx), lower);
    interpolate_down<L>(upper, lower, static_cast<i16>(fy * 256), out);
  }
}

template <int L>
void load_rows(Pixels in, int window, i16* __restrict block) {
  for (int y = 0; y < window + 2; ++y, block += L + 8) {
    const std::uint8_t* __restrict p = in.data + y * in.stride;
    for (int k = 0; k < L + 8; ++k) block[k] = static_cast<i16>(p[k] * kGreyScale - kGreyOffset);
  }
}

// Scharr's gradients need no more than 16 bits at any step: (3 + 10 + 3) * 2048 = 2^15, halved before
// differences.
template <int L>
void template_row(const i16* __restrict block, i16 lowest, i16 highest, i16* __restrict t, i16* __restrict gx,
                  i16* __restrict gy, i16* __restrict m) {
  constexpr int S = L + 8;
  alignas(32) i16 down[S], upper[S], lower[S];
  for (int k = 0; k < S; ++k) {
    down[k] = static_cast<i16>(static_cast<i16>(3 * (block[k] + block[k + 2 * S]) + 10 * block[k + S]) >> 1);
  }
  for (int k = 0; k < L; ++k) {
    upper[k] = static_cast<i16>(static_cast<i16>(3 * (block[k] + block[k + 2]) + 10 * block[k + 1]) >> 1);
    lower[k] = static_cast<i16>(
        static_cast<i16>(3 * (block[k + 2 * S] + block[k + 2 * S + 2]) + 10 * block[k + 2 * S + 1]) >> 1);
  }
  for (int k = 0; k < L; ++k) {
    const i16 v = block[S + k + 1];
    const i16 use = static_cast<i16>(m[k] & (v > lowest) & (v < highest));
    m[k] = use;
    t[k] = static_cast<i16>(v * use);
    gx[k] = static_cast<i16>((static_cast<i16>(down[k + 2] - down[k]) >> 4) * use);
    gy[k] = static_cast<i16>((static_cast<i16>(lower[k] - upper[k]) >> 4) * use);
  }
}

template <int L>
void template_rows(const i16* block, int window, int lowest, int highest, Template out) {
  for (int y = 0; y < window; ++y) {
    template_row<L>(block + y * (L + 8), static_cast<i16>(lowest), static_cast<i16>(highest), out.t + y * L,
                    out.gx + y * L, out.gy + y * L, out.m + y * L);
  }
}

}  // namespace

void sample(Pixels in, int fx, int fy, int window, i16* out) {
  if (lanes(window) == 8) return sample_rows<8>(in, fx, fy, window, out);
  if (lanes(window) == 16) return sample_rows<16>(in, fx, fy, window, out);
  sample_rows<24>(in, fx, fy, window, out);
}

void load_block(Pixels in, int window, i16* block) {
  if (lanes(window) == 8) return load_rows<8>(in, window, block);
  if (lanes(window) == 16) return load_rows<16>(in, window, block);
  load_rows<24>(in, window, block);
}

void make_template(const i16* block, int window, int lowest, int highest, Template out) {
  if (lanes(window) == 8) return template_rows<8>(block, window, lowest, highest, out);
  if (lanes(window) == 16) return template_rows<16>(block, window, lowest, highest, out);
  template_rows<24>(block, window, lowest, highest, out);
}

void mask_template(const Template& in, const i16* image, int count, int lowest, int highest, Template out) {
  const i16* __restrict t = in.t, * __restrict gx = in.gx, * __restrict gy = in.gy, * __restrict m = in.m;
  i16* __restrict ot = out.t, * __restrict ogx = out.gx, * __restrict ogy = out.gy, * __restrict om = out.m;
  for (int k = 0; k < count; ++k) {
    const i16 use = static_cast<i16>(m[k] & (image[k] > lowest) & (image[k] < highest));
    om[k] = use;
    ot[k] = static_cast<i16>(t[k] * use);
    ogx[k] = static_cast<i16>(gx[k] * use);
    ogy[k] = static_cast<i16>(gy[k] * use);
  }
}

bool has_extremes(const i16* image, const i16* m, int count, int lowest, int highest) {
  const i16 lo = static_cast<i16>(lowest), hi = static_cast<i16>(highest);
  i16 found = 0;
  for (int k = 0; k < count; ++k)
    found = static_cast<i16>(found | (m[k] & ((image[k] <= lo) | (image[k] >= hi))));
  return found != 0;
}

TemplateSums sum_template(const Template& in, int count) {
  const i16* __restrict t = in.t, * __restrict gx = in.gx, * __restrict gy = in.gy, * __restrict m = in.m;
  const int n = count & ~31;
  TemplateSums s{};
  for (int k = 0; k < n; ++k) {
    s.n += i32{m[k]} * i32{m[k]};
    s.t += i32{t[k]} * i32{m[k]};
    s.gx += i32{gx[k]} * i32{m[k]};
    s.gy += i32{gy[k]} * i32{m[k]};
    s.tt += i32{t[k]} * i32{t[k]};
  }
  for (int k = 0; k < n; ++k) {
    s.tx += i32{t[k]} * i32{gx[k]};
    s.ty += i32{t[k]} * i32{gy[k]};
    s.xx += i32{gx[k]} * i32{gx[k]};
    s.xy += i32{gx[k]} * i32{gy[k]};
    s.yy += i32{gy[k]} * i32{gy[k]};
  }
  return s;
}

ImageSums sum_image(const Template& in, const i16* image, int count) {
  const i16* __restrict t = in.t, * __restrict gx = in.gx, * __restrict gy = in.gy, * __restrict m = in.m;
  const int n = count & ~31;
  ImageSums s{};
  for (int k = 0; k < n; ++k) {
    s.i += i32{image[k]} * i32{m[k]};
    s.ti += i32{image[k]} * i32{t[k]};
    s.xi += i32{image[k]} * i32{gx[k]};
    s.yi += i32{image[k]} * i32{gy[k]};
  }
  return s;
}

i32 sum_squares(const i16* image, const i16* m, int count) {
  const int n = count & ~31;
  i32 s = 0;
  for (int k = 0; k < n; ++k) {
    const i16 v = static_cast<i16>(image[k] * m[k]);
    s += i32{v} * i32{v};
  }
  return s;
}

}  // namespace pliant::patch
