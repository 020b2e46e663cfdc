#include "vision/gradient_directions.hpp"

namespace pliant {

namespace {

/// Tuning of gradient directions. Each constant: unit, reason, experiment.
struct GradientDirectionTuning {
  /// Added to a gradient's length, grey levels times 8 (the gain of the Sobel gradients): weaker ones count as noise,
  /// 3 grey levels a pixel. No experiment is recorded.
  float noise = 24;
  /// Weight of the mean gradient around a pixel in the length that it is divided by. Round value, not tuned.
  float surround_weight = 1;
};
constexpr GradientDirectionTuning kTuning{};

}  // namespace

void GradientDirectionFilter::lay_out(Arena& arena, int pixels, int columns) {
  pixels_ = pixels;
  columns_ = columns;
  length_ = arena.take<std::uint16_t>(static_cast<std::size_t>(pixels));
  row_sum_ = arena.take<std::uint16_t>(static_cast<std::size_t>(pixels));
  column_sum_ = arena.take<std::uint32_t>(static_cast<std::size_t>(columns));
}

void GradientDirectionFilter::compute_gradients(const ImageView& image, GradientDirection* out) {
  const int w = image.width, h = image.height;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const int at = y * w + x;
      out[at] = {};
      length_[at] = 0;
      if (x == 0 || y == 0 || x == w - 1 || y == h - 1) continue;
      const std::uint8_t *p = image.data + y * image.stride + x, *a = p - image.stride, *b = p + image.stride;
      const int dx = a[1] - a[-1] + 2 * (p[1] - p[-1]) + b[1] - b[-1];
      const int dy = b[-1] - a[-1] + 2 * (b[0] - a[0]) + b[1] - a[1];
      out[at] = {static_cast<std::int16_t>(dx), static_cast<std::int16_t>(dy)};
      length_[at] = static_cast<std::uint16_t>(square_root(static_cast<float>(dx * dx + dy * dy)));
    }
}

// Sums of lengths along each row, `reach` to either side, divided by 16 to fit.
void GradientDirectionFilter::sum_rows(int width, int height, int reach) {
  for (int y = 0; y < height; ++y) {
    const std::uint16_t* line = length_ + y * width;
    std::uint32_t sum = 0;
    for (int x = 0; x < reach && x < width; ++x) sum += line[x];
    for (int x = 0; x < width; ++x) {
      if (x + reach < width) sum += line[x + reach];
      if (x > reach) sum -= line[x - reach - 1];
      row_sum_[y * width + x] = static_cast<std::uint16_t>(sum >> 4);
    }
  }
}

void GradientDirectionFilter::compute(const ImageView& image, int reach, GradientDirection* out) {
  const int w = image.width, h = image.height;
  PLIANT_ASSERT(check(image) == Status::ok && w * h <= pixels_ && w <= columns_ && reach >= 0);
  compute_gradients(image, out);
  sum_rows(w, h, reach);
  for (int x = 0; x < w; ++x) column_sum_[x] = 0;
  for (int y = 0; y < reach && y < h; ++y)
    for (int x = 0; x < w; ++x) column_sum_[x] += row_sum_[y * w + x];
  const float side = static_cast<float>(2 * reach + 1), weight = kTuning.surround_weight * 16 / (side * side);
  for (int y = 0; y < h; ++y) {
    for (int x = 0; y + reach < h && x < w; ++x) column_sum_[x] += row_sum_[(y + reach) * w + x];
    for (int x = 0; y > reach && x < w; ++x) column_sum_[x] -= row_sum_[(y - reach - 1) * w + x];
    for (int x = 0; x < w; ++x) {
      GradientDirection& d = out[y * w + x];
      const float by = 127 / (static_cast<float>(length_[y * w + x]) +
                              weight * static_cast<float>(column_sum_[x]) + kTuning.noise);
      d = {static_cast<std::int16_t>(by * static_cast<float>(d.x)),
           static_cast<std::int16_t>(by * static_cast<float>(d.y))};
    }
  }
}

void EnergyTable::lay_out(Arena& arena, int width, int height) {
  capacity_ = (width + 1) * (height + 1);
  sums_ = arena.take<std::uint32_t>(static_cast<std::size_t>(capacity_));
}

void EnergyTable::build(const GradientDirection* directions, int width, int height) {
  PLIANT_ASSERT((width + 1) * (height + 1) <= capacity_);
  stride_ = width + 1;
  for (int x = 0; x <= width; ++x) sums_[x] = 0;
  for (int y = 0; y < height; ++y) {
    std::uint32_t row = 0;
    sums_[(y + 1) * stride_] = 0;
    for (int x = 0; x < width; ++x) {
      row += static_cast<std::uint32_t>(dot(directions[y * width + x], directions[y * width + x]));
      sums_[(y + 1) * stride_ + x + 1] = sums_[y * stride_ + x + 1] + row;
    }
  }
}

}  // namespace pliant
