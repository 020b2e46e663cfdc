#include "vision/directions.hpp"

namespace pliant {

namespace {

constexpr float kNoiseGrey = 24;  // of the gradients below, which are eight times those of a pixel
constexpr float kOthers = 1;      // weight of the mean gradient around

}  // namespace

void DirectionFinder::lay_out(Arena& arena, int pixels, int columns) {
  length_ = arena.take<std::uint16_t>(static_cast<std::size_t>(pixels));
  row_sum_ = arena.take<std::uint16_t>(static_cast<std::size_t>(pixels));
  column_sum_ = arena.take<std::uint32_t>(static_cast<std::size_t>(columns));
}

void DirectionFinder::find_gradients(const ImageView& image, Direction* out) {
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

/// Sums of lengths along each row, `reach` to either side, into row_sum_ (a sixteenth, to fit).
void DirectionFinder::sum_around(int width, int height, int reach) {
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

void DirectionFinder::find(const ImageView& image, int reach, Direction* out) {
  const int w = image.width, h = image.height;
  find_gradients(image, out);
  sum_around(w, h, reach);
  for (int x = 0; x < w; ++x) column_sum_[x] = 0;
  for (int y = 0; y < reach && y < h; ++y)
    for (int x = 0; x < w; ++x) column_sum_[x] += row_sum_[y * w + x];
  const float side = static_cast<float>(2 * reach + 1), share = kOthers * 16 / (side * side);
  for (int y = 0; y < h; ++y) {
    for (int x = 0; y + reach < h && x < w; ++x) column_sum_[x] += row_sum_[(y + reach) * w + x];
    for (int x = 0; y > reach && x < w; ++x) column_sum_[x] -= row_sum_[(y - reach - 1) * w + x];
    for (int x = 0; x < w; ++x) {
      Direction& d = out[y * w + x];
      const float by = 127 / (static_cast<float>(length_[y * w + x]) +
                              share * static_cast<float>(column_sum_[x]) + kNoiseGrey);
      d = {static_cast<std::int16_t>(by * static_cast<float>(d.x)),
           static_cast<std::int16_t>(by * static_cast<float>(d.y))};
    }
  }
}

PictureAt::PictureAt(const Pyramid& pyramid, float ratio) {
  int level = 0;
  for (; level + 1 < pyramid.levels() && ratio <= 0.5f; ++level) {
    ratio *= 2;
    share_ *= 0.5f;
  }
  image_ = pyramid.level(level);
}

std::uint8_t PictureAt::grey(Vec2 x) const {
  // What is not a number goes to the corner.
  const float sx = share_ * x.x, sy = share_ * x.y;
  const float cx = sx > 0 ? min(sx, static_cast<float>(image_.width - 1)) : 0,
              cy = sy > 0 ? min(sy, static_cast<float>(image_.height - 1)) : 0;
  const int i = static_cast<int>(cx), j = static_cast<int>(cy);
  const int i1 = i + 1 < image_.width ? i + 1 : i, j1 = j + 1 < image_.height ? j + 1 : j;
  const float fx = cx - static_cast<float>(i), fy = cy - static_cast<float>(j);
  const std::uint8_t *a = image_.data + j * image_.stride, *b = image_.data + j1 * image_.stride;
  const float top = static_cast<float>(a[i]) + fx * static_cast<float>(a[i1] - a[i]);
  const float bottom = static_cast<float>(b[i]) + fx * static_cast<float>(b[i1] - b[i]);
  return static_cast<std::uint8_t>(top + fy * (bottom - top) + 0.5f);
}

}  // namespace pliant
