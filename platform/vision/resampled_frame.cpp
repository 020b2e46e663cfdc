#include "vision/resampled_frame.hpp"

#include "vision/bilinear.hpp"

namespace pliant {

ResampledFrame::ResampledFrame(const Pyramid& pyramid, float ratio) {
  int level = 0;
  for (; level + 1 < pyramid.levels() && ratio <= 0.5f; ++level) {
    ratio *= 2;
    level_scale_ *= 0.5f;
  }
  image_ = pyramid.level(level);
}

std::uint8_t ResampledFrame::grey(Vec2 x) const {
  // Written so that a NaN gives 0.
  const float sx = level_scale_ * x.x, sy = level_scale_ * x.y;
  const float cx = sx > 0 ? min(sx, static_cast<float>(image_.width - 1)) : 0,
              cy = sy > 0 ? min(sy, static_cast<float>(image_.height - 1)) : 0;
  const int i = static_cast<int>(cx), j = static_cast<int>(cy);
  const int right = i + 1 < image_.width ? 1 : 0, down = j + 1 < image_.height ? image_.stride : 0;
  const std::uint8_t* p = image_.data + j * image_.stride + i;
  const float grey = bilinear(p, p + down, right, cx - static_cast<float>(i), cy - static_cast<float>(j));
  return static_cast<std::uint8_t>(grey + 0.5f);
}

}  // namespace pliant
