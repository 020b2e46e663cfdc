// Separable binomial smoothing (docs/algorithms.md, section 7.1): first down the columns into one line of 16-bit
// sums, then along the line at every other pixel. Every step is a plain loop over 16-bit integers (binomial.hpp).
// Compilers turn it into vector code, and the result does not depend on how they do so.
#include "pliant/pyramid.hpp"

#include <cstring>

#include "base/wide_vectors.hpp"
#include "vision/binomial.hpp"
#include "vision/halfwords.hpp"

namespace pliant {
namespace {

constexpr int kMaxSide = 16384;
constexpr int kBorder = 2;      // taps beyond the border on either side
constexpr int kLineOffset = 8;  // where a line starts, so that its pixels are aligned

bool is_valid(const PyramidLimits& l) {
  return l.width >= Pyramid::kMinSide && l.width <= kMaxSide && l.height >= Pyramid::kMinSide &&
         l.height <= kMaxSide && l.levels >= 1 && l.levels <= Pyramid::kMaxLevels;
}

// Index i of a row of n >= 3, reflected about the edge pixels; |i| at most kBorder outside.
int reflected(int i, int n) {
  return i < 0 ? -i : i >= n ? 2 * (n - 1) - i : i;
}

PLIANT_WIDE_VECTORS
void smooth_columns(const ImageView& src, int y, std::uint16_t* __restrict line) {
  const std::uint8_t* row[5];
  for (int k = 0; k < 5; ++k)
    row[k] = src.data + static_cast<std::ptrdiff_t>(reflected(y + k - kBorder, src.height)) * src.stride;
  const std::uint8_t *a = row[0], *b = row[1], *c = row[2], *d = row[3], *e = row[4];
  int x = 0;
#if PLIANT_HAS_HALFWORDS
  using namespace patch;
  for (; x + 4 <= src.width; x += 4) {
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
#endif
  for (; x < src.width; ++x) line[x] = static_cast<std::uint16_t>(binomial_sum(a[x], b[x], c[x], d[x], e[x]));
}

void reflect_ends(std::uint16_t* line, int width) {
  for (int k = 1; k <= kBorder; ++k) {
    line[-k] = line[k];
    line[width - 1 + k] = line[width - 1 - k];
  }
}

PLIANT_WIDE_VECTORS
void smooth_and_halve_row(const std::uint16_t* __restrict line, int out_width, std::uint8_t* __restrict out) {
#if PLIANT_HAS_HALFWORDS
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
#else
  for (int x = 0; x < out_width; ++x) {
    const std::uint16_t* v = line + 2 * x;
    out[x] = binomial_mean(v[-2], v[-1], v[0], v[1], v[2]);
  }
#endif
}

void halve(const ImageView& src, std::uint8_t* out, int out_width, int out_height, std::uint16_t* line) {
  for (int y = 0; y < out_height; ++y, out += out_width) {
    smooth_columns(src, 2 * y, line);
    reflect_ends(line, src.width);
    smooth_and_halve_row(line, out_width, out);
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
