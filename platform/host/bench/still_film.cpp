#include "host/bench/still_film.hpp"

#include <algorithm>
#include <cmath>

#include "host/bench/random.hpp"

namespace pliant::host {

namespace {

/// Frames of one loop of the drift.
constexpr float kLoopFrames = 60;

float bilinear(const Image& image, float x, float y) {
  x = std::clamp(x, 0.0f, static_cast<float>(image.width - 1));
  y = std::clamp(y, 0.0f, static_cast<float>(image.height - 1));
  const int i = std::min(static_cast<int>(x), std::max(image.width - 2, 0));
  const int j = std::min(static_cast<int>(y), std::max(image.height - 2, 0));
  const int i1 = std::min(i + 1, image.width - 1), j1 = std::min(j + 1, image.height - 1);
  const float a = x - static_cast<float>(i), b = y - static_cast<float>(j);
  const float upper = (1 - a) * *image.at(i, j) + a * *image.at(i1, j);
  const float lower = (1 - a) * *image.at(i, j1) + a * *image.at(i1, j1);
  return (1 - b) * upper + b * lower;
}

std::uint8_t grey_of(float value) {
  return static_cast<std::uint8_t>(std::clamp(value, 0.0f, 255.0f) + 0.5f);
}

/// Half of the size, each pixel the mean of four.
Image halved(const Image& image) {
  Image out(std::max(image.width / 2, 1), std::max(image.height / 2, 1), 1);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      int sum = 2;
      for (int k = 0; k < 4; ++k)
        sum += *image.at(std::min(2 * x + k % 2, image.width - 1), std::min(2 * y + k / 2, image.height - 1));
      *out.at(x, y) = static_cast<std::uint8_t>(sum / 4);
    }
  return out;
}

}  // namespace

void add_grey_noise(Image& image, float standard_deviation, std::uint32_t seed) {
  BenchRandom random{seed * 2654435761u | 1u};
  for (std::uint8_t& pixel : image.pixels) {
    // The sum of four uniform numbers has the variance 1/3.
    const std::uint32_t a = random.bits();
    const float sum =
        static_cast<float>((a & 255u) + (a >> 8 & 255u) + (a >> 16 & 255u) + (a >> 24)) / 256 - 2;
    pixel = grey_of(static_cast<float>(pixel) + 1.7320508f * standard_deviation * sum);
  }
}

Vec2 StillFilm::shift(std::size_t k) const {
  const float angle = 6.2831853f * static_cast<float>(k) / kLoopFrames;
  return options_.drift_px * Vec2{std::sin(angle), 0.5f * (1 - std::cos(angle))};
}

FrameView StillFilm::frame(std::size_t k) {
  frame_ = Image(picture_.width, picture_.height, 1);
  const Vec2 by = shift(k);
  for (int y = 0; y < frame_.height; ++y)
    for (int x = 0; x < frame_.width; ++x)
      *frame_.at(x, y) =
          grey_of(bilinear(picture_, static_cast<float>(x) - by.x, static_cast<float>(y) - by.y));
  add_grey_noise(frame_, options_.noise_grey, options_.seed * 1000 + static_cast<std::uint32_t>(k));
  return frame_of(frame_, k);
}

Image resized(const Image& grey, float scale) {
  Image source = grey;
  while (scale <= 0.5f && source.width > 1 && source.height > 1) {
    source = halved(source);
    scale *= 2;
  }
  Image out(std::max(static_cast<int>(scale * static_cast<float>(source.width)), 1),
            std::max(static_cast<int>(scale * static_cast<float>(source.height)), 1), 1);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      *out.at(x, y) = grey_of(bilinear(source, (static_cast<float>(x) + 0.5f) / scale - 0.5f,
                                       (static_cast<float>(y) + 0.5f) / scale - 0.5f));
  return out;
}

Image turned(const Image& grey, float radians) {
  const float cosine = std::cos(radians), sine = std::sin(radians);
  const Vec2 middle = 0.5f * Vec2{static_cast<float>(grey.width - 1), static_cast<float>(grey.height - 1)};
  Image out(grey.width, grey.height, 1);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      const Vec2 d = Vec2{static_cast<float>(x), static_cast<float>(y)} - middle;
      *out.at(x, y) =
          grey_of(bilinear(grey, middle.x + cosine * d.x + sine * d.y, middle.y - sine * d.x + cosine * d.y));
    }
  return out;
}

void lay_over(Image& background, const Image& picture, int x, int y, int margin) {
  for (int j = 0; j < picture.height; ++j)
    for (int i = 0; i < picture.width; ++i) {
      if (!background.contains(x + i, y + j)) continue;
      const int inside = std::min({i, j, picture.width - 1 - i, picture.height - 1 - j, margin});
      const float a = (static_cast<float>(inside) + 1) / (static_cast<float>(margin) + 1);
      std::uint8_t& pixel = *background.at(x + i, y + j);
      pixel = grey_of((1 - a) * pixel + a * *picture.at(i, j));
    }
}

}  // namespace pliant::host
