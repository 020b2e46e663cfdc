#include "host/learn/mipmap.hpp"

#include <algorithm>
#include <cmath>

namespace pliant::host::learn {

namespace {

/// The picture at half its size, by averages of 2 x 2 pixels; an odd last row or column is averaged alone.
Image halved(const Image& image) {
  Image half((image.width + 1) / 2, (image.height + 1) / 2, 1);
  for (int y = 0; y < half.height; ++y)
    for (int x = 0; x < half.width; ++x) {
      const int x1 = std::min(2 * x + 1, image.width - 1), y1 = std::min(2 * y + 1, image.height - 1);
      const int sum =
          *image.at(2 * x, 2 * y) + *image.at(x1, 2 * y) + *image.at(2 * x, y1) + *image.at(x1, y1);
      *half.at(x, y) = static_cast<std::uint8_t>((sum + 2) / 4);
    }
  return half;
}

}  // namespace

Mipmap::Mipmap(const Image& picture) {
  levels_.push_back(picture);
  while (levels_.back().width > 2 && levels_.back().height > 2) levels_.push_back(halved(levels_.back()));
}

Mipmap::Detail Mipmap::detail_for(float px_per_px) const {
  // A bilinear sample covers its level's pixels well up to a step of about 1.2 of them.
  const float exact = std::log2(std::max(px_per_px / 1.2f, 1.0f));
  const int last = static_cast<int>(levels_.size()) - 1;
  if (exact >= static_cast<float>(last)) return {last, 0};
  const int level = static_cast<int>(exact);
  return {level, exact - static_cast<float>(level)};
}

float Mipmap::at(Vec2 x, const Detail& detail) const {
  const float outside = max(max(-x.x, x.x - static_cast<float>(width() - 1)),
                            max(-x.y, x.y - static_cast<float>(height() - 1)));
  if (outside > 0) {
    const Detail coarse = detail_for(0.5f * outside);
    if (coarse.level > detail.level)
      return bilinear(x, coarse.level) +
             coarse.next * (bilinear(x, std::min(coarse.level + 1, static_cast<int>(levels_.size()) - 1)) -
                            bilinear(x, coarse.level));
  }
  const float value = bilinear(x, detail.level);
  if (detail.next <= 0.02f) return value;
  return value + detail.next * (bilinear(x, detail.level + 1) - value);
}

float Mipmap::bilinear(Vec2 x, int level) const {
  const Image& image = levels_[static_cast<std::size_t>(level)];
  const float scale = 1.0f / static_cast<float>(1 << level);
  const float px = clamp((x.x + 0.5f) * scale - 0.5f, 0, static_cast<float>(image.width - 1)),
              py = clamp((x.y + 0.5f) * scale - 0.5f, 0, static_cast<float>(image.height - 1));
  const int i = static_cast<int>(px), j = static_cast<int>(py);
  const int right = i + 1 < image.width ? 1 : 0, down = j + 1 < image.height ? image.width : 0;
  const float fx = px - static_cast<float>(i), fy = py - static_cast<float>(j);
  const std::uint8_t* p = image.at(i, j);
  const auto value = [&](int offset) { return static_cast<float>(p[offset]); };
  const float top = value(0) + fx * (value(right) - value(0));
  const float low = value(down) + fx * (value(down + right) - value(down));
  return top + fy * (low - top);
}

}  // namespace pliant::host::learn
