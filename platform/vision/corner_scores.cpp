#include "vision/corner_scores.hpp"

#include <cstring>

#include "vision/halfwords.hpp"

namespace pliant::corners {
namespace {

// Loops that read neighbours have no __restrict. With it, Clang keeps values from one iteration to the next and does not
// vectorise the loop.

using i16 = std::int16_t;
using i32 = std::int32_t;

// 1 / (gain^2 * pixels): from sums to the mean squared gradient.
constexpr float kMean = 1.0f / (32.0f * 32.0f * kWindow * kWindow);

// Gradients of `n` pixels. b points at the pixel left of the first one; `down` has room for n + 2.
void scharr(const std::uint8_t* b, std::ptrdiff_t stride, int n, i16* down, i16* gx, i16* gy) {
  const std::uint8_t *a = b - stride, *c = b + stride;
  for (int x = 0; x < n + 2; ++x) down[x] = static_cast<i16>(3 * (a[x] + c[x]) + 10 * b[x]);
  for (int x = 0; x < n; ++x) gx[x] = static_cast<i16>(down[x + 2] - down[x]);
  for (int x = 0; x < n; ++x)
    gy[x] = static_cast<i16>(3 * ((c[x] - a[x]) + (c[x + 2] - a[x + 2])) + 10 * (c[x + 1] - a[x + 1]));
}

void add_products(const i16* __restrict gx, const i16* __restrict gy, int n, i32 sign, i32* __restrict xx,
                  i32* __restrict xy, i32* __restrict yy) {
  for (int x = 0; x < n; ++x) {
    const i32 ax = gx[x], ay = gy[x];
    xx[x] += sign * (ax * ax);
    xy[x] += sign * (ax * ay);
    yy[x] += sign * (ay * ay);
  }
}

void sum_window(const i32* in, int n, i32* out) {
#if PLIANT_HAS_HALFWORDS  // no vectors
  i32 sum = 0;
  for (int x = 0; x < kWindow - 1; ++x) sum += in[x];
  for (int x = 0; x < n; ++x) {
    sum += in[x + kWindow - 1];
    out[x] = sum;
    sum -= in[x];
  }
#else
  for (int x = 0; x < n; ++x)
    out[x] = in[x] + in[x + 1] + in[x + 2] + in[x + 3] + in[x + 4] + in[x + 5] + in[x + 6];
#endif
}

float smallest_eigenvalue(float xx, float xy, float yy) {
  const float difference = xx - yy;
  const float smallest = 0.5f * (xx + yy - __builtin_sqrtf(difference * difference + 4.0f * xy * xy));
  return smallest > 0 ? smallest : 0;
}

}  // namespace

float score_of(const Tensor& t) {
  return kMean *
         smallest_eigenvalue(static_cast<float>(t.xx), static_cast<float>(t.xy), static_cast<float>(t.yy));
}

void RowScorer::lay_out(Arena& arena, int columns) {
  const auto scored = static_cast<std::size_t>(columns), with_window = scored + 2 * kRadius;
  for (int k = 0; k < kWindow; ++k) {
    gx_[k] = arena.take<i16>(with_window);
    gy_[k] = arena.take<i16>(with_window);
  }
  xx_ = arena.take<i32>(with_window);
  xy_ = arena.take<i32>(with_window);
  yy_ = arena.take<i32>(with_window);
  wxx_ = arena.take<i32>(scored);
  wxy_ = arena.take<i32>(scored);
  wyy_ = arena.take<i32>(scored);
  smooth_ = arena.take<i16>(with_window + 2);
}

void RowScorer::start(const ImageView& image, int first, int end, int y) {
  PLIANT_ASSERT(first >= kCornerMargin && end <= image.width - kCornerMargin && y >= kCornerMargin);
  image_ = &image;
  first_ = first;
  columns_ = end - first;
  y_ = y;
  const std::size_t bytes = static_cast<std::size_t>(columns_ + 2 * kRadius) * sizeof(i32);
  std::memset(xx_, 0, bytes);
  std::memset(xy_, 0, bytes);
  std::memset(yy_, 0, bytes);
  for (int row = y - kRadius; row < y + kRadius; ++row) add_row(row, 1);
}

void RowScorer::add_row(int y, int sign) {
  const int n = columns_ + 2 * kRadius;
  i16 *gx = gx_[y % kWindow], *gy = gy_[y % kWindow];
  if (sign > 0) {
    const std::uint8_t* p =
        image_->data + static_cast<std::ptrdiff_t>(y) * image_->stride + first_ - kRadius - 1;
    scharr(p, image_->stride, n, smooth_, gx, gy);
  }
  add_products(gx, gy, n, sign, xx_, xy_, yy_);
}

void RowScorer::next(float min_ratio, float* scores) {
  add_row(y_ + kRadius, 1);
  sum_window(xx_, columns_, wxx_);
  sum_window(xy_, columns_, wxy_);
  sum_window(yy_, columns_, wyy_);
  const i32* __restrict wxx = wxx_, * __restrict wxy = wxy_, * __restrict wyy = wyy_;
  float* __restrict out = scores;
  for (int x = 0; x < columns_; ++x) {
    const auto xx = static_cast<float>(wxx[x]), yy = static_cast<float>(wyy[x]);
    const float smallest = smallest_eigenvalue(xx, static_cast<float>(wxy[x]), yy);
    out[x] = smallest >= min_ratio * (xx + yy - smallest) ? kMean * smallest : 0.0f;
  }
  add_row(y_ - kRadius, -1);
  ++y_;
}

}  // namespace pliant::corners
