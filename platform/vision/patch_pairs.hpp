#pragma once
// The kernels of patch_sums.hpp, patch_sampling.hpp and patch_gradients.cpp for two elements at a time
// (halfwords.hpp): the same bits as the plain loops, in a third of the instructions of a Cortex-M7. Shifts of
// both elements are sums cut in half, products of an element and a fraction are rearranged where that leaves
// the same integers. Columns go down the window from the last to the first: each writes one element beyond
// the end of a row, which is the first of the next row.
#include "vision/cubic_phase.hpp"
#include "vision/halfwords.hpp"
#include "vision/patch_sampling.hpp"
#include "vision/patch_sums.hpp"

namespace pliant::patch::pairs {

/// Elements of a row that are computed: `window` is odd.
constexpr int columns(int window) {
  return window + 1;
}

// --- sums ---

inline bool is_within(const i16* v, int count, GreyRange range) {
  const Pair least = pair_of(range.lowest + 1, range.lowest + 1),
             most = pair_of(range.highest - 1, range.highest - 1);
  Pair signs = 0;
  const i16* const end = v + count;
  do {
    Pair p, q;
    take_four(v, p, q);
    signs |= subtract(p, least) | subtract(most, p) | subtract(q, least) | subtract(most, q);
  } while (v != end);
  return (static_cast<std::uint32_t>(signs) & 0x80008000u) == 0;
}

/// Adds the products of four elements p, q with the next four of a.
[[gnu::always_inline]] inline void add_four(Pair p, Pair q, const i16*& a, i32& sum) {
  Pair first, second;
  take_four(a, first, second);
  sum = add_products(q, second, add_products(p, first, sum));
}

inline Sums4 dot4(const i16* v, const i16* a, const i16* b, const i16* c, const i16* d, int count) {
  i32 va = 0, vb = 0, vc = 0, vd = 0;
  const i16* const end = v + count;
  do {
    Pair p, q;
    take_four(v, p, q);
    add_four(p, q, a, va);
    add_four(p, q, b, vb);
    add_four(p, q, c, vc);
    add_four(p, q, d, vd);
  } while (v != end);
  return {va, vb, vc, vd};
}

inline i32 dot(const i16* v, const i16* a, int count) {
  i32 sum = 0;
  const i16* const end = v + count;
  do {
    Pair p, q;
    take_four(v, p, q);
    add_four(p, q, a, sum);
  } while (v != end);
  return sum;
}

inline void multiply_by_position(const i16* g, const i16* x, const i16* y, int count, i16* by_x, i16* by_y) {
  for (int k = 0; k < count; k += 2) {
    const Pair p = load_pair(g + k);
    store_pair(product<4>(p, load_pair(x + k)), by_x + k);
    store_pair(product<4>(p, load_pair(y + k)), by_y + k);
  }
}

// --- sampling ---

/// 16 pixel - 2048, four pixels at a time.
inline void load_rows(const std::uint8_t* pixels, std::ptrdiff_t stride, int rows, int row_length, i16* out) {
  constexpr Pair kOffset = pair_of(kGreyOffset, kGreyOffset);
  const std::ptrdiff_t to_next = stride - row_length;
  for (int y = 0; y < rows; ++y, pixels += to_next)
    for (const i16* const end = out + row_length; out != end; out += 4, pixels += 4) {
      const std::uint32_t four = load_bytes(pixels);
      const Pair even = subtract(add_even_bytes(0, four) << 4, kOffset),
                 odd = subtract(add_odd_bytes(0, four) << 4, kOffset);
      store_pair(lowers(even, odd), out);
      store_pair(uppers(even, odd), out + 2);
    }
}

/// 4 v + (8 (next - v) t >> 16) with t = 256 f is ((128 - f) v + f next) >> 5.
inline void linear_across(const i16* v, int rows, int row_length, int window, int f, i16* out) {
  const Pair weights = pair_of(kSubpixel - f, f);
  const int rest = row_length - columns(window);
  for (int y = 0; y < rows; ++y, v += rest, out += rest)
    for (const i16* const end = out + columns(window); out != end; v += 2, out += 2)
      store_pair(
          shifted<5>(add_products(load_pair(v), weights, 0), add_products(load_pair(v + 1), weights, 0)),
          out);
}

inline void linear_down(const i16* h, int row_length, int window, int f, i16* out) {
  const i16 t = narrow(f * 256);
  for (int k = window - 1; k >= 0; k -= 2) {
    const i16* p = h + k;
    i16* o = out + k;
    Pair upper = load_pair(p);
    for (const i16* const end = o + window * window; o != end; o += window) {
      p += row_length;
      const Pair lower = load_pair(p);
      const Pair half = half_sum(upper, pair_of(2, 2));
      store_pair(half_sum(half, mulhi(subtract(lower, upper), t)), o);
      upper = lower;
    }
  }
}

/// The cubic of patch_sampling.cpp along rows. (s2 - s1) t and the line are sums of products of the samples a, b, c, d.
/// The line is computed with the opposite sign, because the weight of b would not fit: x >> n = ~((-x - 1) >> n).
inline void cubic_across(const i16* v, int rows, int row_length, int window, int f, i16* out) {
  const CubicPhase phase = cubic_phase(f);
  const Pair of_ab = pair_of(-f, 3 * f), of_cd = pair_of(-3 * f, f),
             of_bc = pair_of(phase.line - 32768, phase.line);
  const int rest = row_length - columns(window);
  for (int y = 0; y < rows; ++y, v += rest, out += rest)
    for (const i16* const end = out + columns(window); out != end; v += 2, out += 2) {
      const Pair ab = load_pair(v), bc = load_pair(v + 1), cd = load_pair(v + 2), de = load_pair(v + 3);
      const Pair change = shifted<8>(add_products(cd, of_cd, add_products(ab, of_ab, 0)),
                                     add_products(de, of_cd, add_products(bc, of_ab, 0)));
      const Pair half = subtract(change, bc);
      const Pair curve = add(add(add(ab, cd), half), half);
      const Pair minus_line = shifted<13>(add_difference(bc, of_bc, -1), add_difference(cd, of_bc, -1));
      store_pair(~add(minus_line, mulhi(add(curve, curve), phase.bend)), out);
    }
}

inline void cubic_down(const i16* h, int row_length, int window, int f, i16* out) {
  const CubicPhase phase = cubic_phase(f);
  const auto quarter = [](Pair p) { return half_sum(half_sum(p, 0), 0); };
  for (int k = window - 1; k >= 0; k -= 2) {
    const i16* p = h + k;
    i16* o = out + k;
    Pair h1 = load_pair(p + row_length), h2 = load_pair(p + 2 * row_length);
    Pair b = quarter(h1), c = quarter(h2), s1 = subtract(add(quarter(load_pair(p)), c), add(b, b));
    p += 3 * row_length;
    for (const i16* const end = o + window * window; o != end; o += window, p += row_length) {
      const Pair h3 = load_pair(p), d = quarter(h3), s2 = subtract(subtract(add(b, d), c), c);
      const Pair change = mulhi(subtract(s2, s1), phase.blend), curve = add(add(s1, change), change);
      const Pair on_line = half_sum(half_sum(h1, pair_of(2, 2)), mulhi(subtract(h2, h1), phase.line));
      store_pair(saturated12(subtract(on_line, half_sum(mulhi(curve, phase.bend), 0))), o);
      s1 = s2;
      b = c;
      c = d;
      h1 = h2;
      h2 = h3;
    }
  }
}

/// As the functions of these names.
inline void sample_linear(const i16* block, int fx, int fy, int window, i16* scratch, i16* out) {
  const int row_length = block_stride(window);
  linear_across(block + row_length + 1, window + 1, row_length, window, fx, scratch);
  linear_down(scratch, row_length, window, fy, out);
}

inline void sample_cubic(const i16* block, int fx, int fy, int window, i16* scratch, i16* out) {
  const int row_length = block_stride(window);
  cubic_across(block, window + 3, row_length, window, fx, scratch);
  cubic_down(scratch, row_length, window, fy, out);
}

/// The line between the two pixels of a pair, at t / 2^15, in 1/64 grey.
inline i32 blend(std::uint16_t pair, i32 t) {
  const i32 first = pair & 255, second = pair >> 8;
  return ((first << kLatticeBits) + (second - first) * t) >> (kLatticeBits - 6);
}

/// One sample at a time, because each has pixels of its own.
inline void sample_lattice(const std::uint8_t* pixels, int stride, const Lattice& at, int window,
                           i16* block) {
  constexpr i32 kFraction = (1 << kLatticeBits) - 1;
  const int columns = window + 2, to_next = block_stride(window) - columns;
  for (int j = 0; j < columns; ++j, block += to_next) {
    i32 x = at.x + j * at.down_x, y = at.y + j * at.down_y;
    for (const i16* const end = block + columns; block != end; ++block) {
      const std::uint8_t* p = pixels + (y >> kLatticeBits) * stride + (x >> kLatticeBits);
      std::uint16_t upper, lower;
      std::memcpy(&upper, p, sizeof upper);
      std::memcpy(&lower, p + stride, sizeof lower);
      const i32 h0 = blend(upper, x & kFraction), h1 = blend(lower, x & kFraction);
      const i32 v = h1 + 2 * (((h1 - h0) * ((y & kFraction) - (1 << kLatticeBits))) >> 16);
      *block = narrow(((v + 2) >> 2) - kGreyOffset);
      x += at.across_x;
      y += at.across_y;
    }
  }
}

// --- templates ---

/// (3 a + 10 b + 3 c) >> 1 = (3 (a + c + 3 b) + b) >> 1.
inline void smooth3(const i16* in, int step, int count, i16* out) {
  for (const i16* const end = in + count; in != end; in += 2, out += 2) {
    const Pair b = load_pair(in + step);
    const Pair t = add(add(load_pair(in), load_pair(in + 2 * step)), add(add(b, b), b));
    store_pair(half_sum(add(add(t, t), t), b), out);
  }
}

inline void mask_row(const i16* v, const i16* mask, int count, i16* t, i16* m) {
  constexpr GreyRange r = kUsableGrey;
  constexpr Pair kLeast = pair_of(r.lowest + 1, r.lowest + 1), kMost = pair_of(r.highest - 1, r.highest - 1);
  for (int k = 0; k < count; k += 2) {
    const Pair p = load_pair(v + k);
    const auto out = static_cast<std::uint32_t>(subtract(p, kLeast) | subtract(kMost, p));
    const Pair use = load_pair(mask + k) & static_cast<Pair>(~(out >> 15));
    store_pair(use, m + k);
    store_pair(
        p & static_cast<Pair>((static_cast<std::uint32_t>(use) << 16) - static_cast<std::uint32_t>(use)),
        t + k);
  }
}

inline void gradient_row(const i16* before, const i16* after, const i16* m, int count, i16* out) {
  for (int k = 0; k < count; k += 2)
    store_pair(product<4>(subtract(load_pair(after + k), load_pair(before + k)), load_pair(m + k)), out + k);
}

}  // namespace pliant::patch::pairs
