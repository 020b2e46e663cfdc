// Separable binomial smoothing (docs/algorithms.md, section 7.1): first down the columns into one line of 16-bit
// sums, then along the line at every other pixel. Every step is a plain loop over 16-bit integers (binomial.hpp).
// Compilers turn it into vector code, and the result does not depend on how they do so.
#include "pliant/pyramid.hpp"

#include <cstring>

#include "base/wide_vectors.hpp"
#include "vision/binomial.hpp"
#include "vision/halfwords.hpp"
#include "vision/largest_side.hpp"

namespace pliant {
namespace {

constexpr int kBorder = 2;      // taps beyond the border on either side
constexpr int kLineOffset = 8;  // where a line starts, so that its pixels are aligned

bool is_valid(const PyramidLimits& l) {
  return l.width >= Pyramid::kMinSide && l.width <= kLargestSidePx && l.height >= Pyramid::kMinSide &&
         l.height <= kLargestSidePx && l.levels >= 1 && l.levels <= Pyramid::kMaxLevels;
}

// Index i of a row of n >= 3, reflected about the edge pixels; |i| at most kBorder outside.
int reflected(int i, int n) {
  return i < 0 ? -i : i >= n ? 2 * (n - 1) - i : i;
}

#if PLIANT_HAS_HALFWORDS

void smooth_columns(const std::uint8_t* const (&row)[5], int width, std::uint16_t* line) {
  using namespace patch;
  const std::uint8_t *a = row[0], *b = row[1], *c = row[2], *d = row[3], *e = row[4];
  int x = 0;
  for (; x + 4 <= width; x += 4) {
    const std::uint32_t wa = load_bytes(a + x), wb = load_bytes(b + x), wc = load_bytes(c + x),
                        wd = load_bytes(d + x), we = load_bytes(e + x);
    const Pair even_c = add_even_bytes(0, wc), odd_c = add_odd_bytes(0, wc);
    const Pair even = add_even_bytes(add_even_bytes(0, wa), we) +
                      4 * add_even_bytes(add_even_bytes(0, wb), wd) + 6 * even_c;
    const Pair odd =
        add_odd_bytes(add_odd_bytes(0, wa), we) + 4 * add_odd_bytes(add_odd_bytes(0, wb), wd) + 6 * odd_c;
    const Pair out[2] = {lowers(even, odd), uppers(even, odd)};
    std::memcpy(line + x, out, sizeof out);
  }
  for (; x < width; ++x) line[x] = static_cast<std::uint16_t>(binomial_sum(a[x], b[x], c[x], d[x], e[x]));
}

void reflect_ends(std::uint16_t* line, int width) {
  for (int k = 1; k <= kBorder; ++k) {
    line[-k] = line[k];
    line[width - 1 + k] = line[width - 1 - k];
  }
}

void smooth_and_halve_row(const std::uint16_t* line, int out_width, std::uint8_t* out) {
  using namespace patch;
  constexpr Pair kFirst = pair_of(1, 4), kSecond = pair_of(6, 4);
  Pair before, here;  // of the pixels -2 and -1, and of 0 and 1; sums of columns are less than 2^12
  std::memcpy(&before, line - 2, sizeof before);
  std::memcpy(&here, line, sizeof here);
  for (int x = 0; x < out_width; ++x) {
    Pair after;
    std::memcpy(&after, line += 2, sizeof after);
    const i32 sum = add_products(here, kSecond, add_products(before, kFirst, 128)) + low(after);
    out[x] = static_cast<std::uint8_t>(sum >> 8);
    before = here;
    here = after;
  }
}

void halve_row(const std::uint8_t* const (&row)[5], int width, std::uint16_t* line, std::uint8_t* out) {
  smooth_columns(row, width, line);
  reflect_ends(line, width);
  smooth_and_halve_row(line, (width + 1) / 2, out);
}

#else

// Calls f(from, count) for parts of [0, n) that are whole vectors. The last one overlaps: its elements are computed twice.
template <class F>
inline void in_vectors(int n, F f) {
  constexpr int kVector = 16;
  for (int x = 0; x < n && n < kVector; ++x) f(x, 1);
  if (n < kVector) return;
  f(0, n & -kVector);
  f(n - kVector, kVector);
}

inline std::uint16_t pair_at(const std::uint8_t* row, int x) {
  std::uint16_t pair;
  std::memcpy(&pair, row + 2 * x, sizeof pair);
  return pair;
}

// Pixels are read in pairs, and the sums of even and odd columns kept apart: so no later vector takes every other element.
inline void smooth_columns(const std::uint8_t* const (&row)[5], int from, int count,
                           std::uint16_t* __restrict even, std::uint16_t* __restrict odd) {
  for (int x = from; x < from + count; ++x) {
    const std::uint16_t a = pair_at(row[0], x), b = pair_at(row[1], x), c = pair_at(row[2], x),
                        d = pair_at(row[3], x), e = pair_at(row[4], x);
    even[x] = static_cast<std::uint16_t>(binomial_sum(a & 255, b & 255, c & 255, d & 255, e & 255));
    odd[x] = static_cast<std::uint16_t>(binomial_sum(a >> 8, b >> 8, c >> 8, d >> 8, e >> 8));
  }
}

inline void smooth_row(const std::uint16_t* __restrict even, const std::uint16_t* __restrict odd, int from,
                       int count, std::uint8_t* __restrict out) {
  for (int x = from; x < from + count; ++x)
    out[x] = binomial_mean(even[x - 1], odd[x - 1], even[x], odd[x], even[x + 1]);
}

PLIANT_WIDE_VECTORS
void halve_row(const std::uint8_t* const (&row)[5], int width, std::uint16_t* line, std::uint8_t* out) {
  const int pairs = width / 2, out_width = width - pairs, last = width - 1;
  std::uint16_t *const even = line, *const odd = line + out_width + kBorder;
  in_vectors(pairs, [&](int from, int count) { smooth_columns(row, from, count, even, odd); });
  if (out_width > pairs)
    even[pairs] = static_cast<std::uint16_t>(
        binomial_sum(row[0][last], row[1][last], row[2][last], row[3][last], row[4][last]));
  even[-1] = even[1];
  odd[-1] = odd[0];
  even[out_width] = even[pairs - 1];
  odd[pairs] = odd[pairs - 1];
  in_vectors(out_width, [&](int from, int count) { smooth_row(even, odd, from, count, out); });
}

#endif

void halve(const ImageView& src, std::uint8_t* out, int out_width, int out_height, std::uint16_t* line) {
  for (int y = 0; y < out_height; ++y, out += out_width) {
    const std::uint8_t* row[5];
    for (int k = 0; k < 5; ++k)
      row[k] =
          src.data + static_cast<std::ptrdiff_t>(reflected(2 * y + k - kBorder, src.height)) * src.stride;
    halve_row(row, src.width, line, out);
  }
}

void copy_frame(const FrameView& frame, std::uint8_t* out) {
  const auto width = static_cast<std::size_t>(frame.width);
  const auto step = static_cast<std::size_t>(frame.pixel_step_bytes);
  const std::uint8_t* row = frame.data;
  for (int y = 0; y < frame.height; ++y, row += frame.stride_bytes, out += width) {
    if (step == 1) {
      std::memcpy(out, row, width);
    } else {
      for (std::size_t x = 0; x < width; ++x) out[x] = row[x * step];
    }
  }
}

}  // namespace

Status Pyramid::create(Arena& arena, const PyramidLimits& limits) {
  return is_valid(limits) ? create_in(arena, *this, limits) : Status::bad_argument;
}

void Pyramid::lay_out(Arena& arena, const PyramidLimits& limits) {
  is_built_ = false;
  levels_ = 0;
  int width = limits.width, height = limits.height;
  while (levels_ < limits.levels && levels_ < kMaxLevels && width >= kMinSide && height >= kMinSide) {
    const bool has_pixels = levels_ > 0 || limits.copies_frame;
    const auto bytes = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    pixels_[levels_] = has_pixels ? arena.take<std::uint8_t>(bytes) : nullptr;
    views_[levels_] = {pixels_[levels_], width, height, width};
    ++levels_;
    width = (width + 1) / 2;
    height = (height + 1) / 2;
  }
  line_ = arena.take<std::uint16_t>(static_cast<std::size_t>(limits.width) + 2 * kLineOffset);
}

Status Pyramid::build(const FrameView& frame) {
  if (levels_ == 0) return Status::not_ready;
  if (const Status s = check(frame); s != Status::ok) return s;
  if (frame.width != views_[0].width || frame.height != views_[0].height) return Status::size_mismatch;
  if (pixels_[0] != nullptr) {
    copy_frame(frame, pixels_[0]);
  } else {
    constexpr std::size_t kMaxStride = 1u << 24;  // far more than any row; keeps offsets inside an int
    if (frame.pixel_step_bytes != 1 || frame.stride_bytes > kMaxStride) return Status::bad_argument;
    views_[0].data = frame.data;
    views_[0].stride = static_cast<int>(frame.stride_bytes);
  }
  for (int l = 1; l < levels_; ++l)
    halve(views_[l - 1], pixels_[l], views_[l].width, views_[l].height, line_ + kLineOffset);
  is_built_ = true;
  return Status::ok;
}

void Pyramid::swap(Pyramid& other) {
  const auto exchange = [](auto& a, auto& b) {
    const auto t = a;
    a = b;
    b = t;
  };
  for (int l = 0; l < kMaxLevels; ++l) {
    exchange(views_[l], other.views_[l]);
    exchange(pixels_[l], other.pixels_[l]);
  }
  exchange(line_, other.line_);
  exchange(levels_, other.levels_);
  exchange(is_built_, other.is_built_);
}

}  // namespace pliant
