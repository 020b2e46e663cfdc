#include "host/io/image.hpp"

#include <algorithm>
#include <cmath>

namespace pliant::host {

Image image_of(const FrameView& frame) {
  Image image(frame.width, frame.height, 1);
  for (int y = 0; y < frame.height; ++y)
    for (int x = 0; x < frame.width; ++x)
      *image.at(x, y) =
          frame.data[static_cast<std::size_t>(y) * frame.stride_bytes +
                     static_cast<std::size_t>(x) * static_cast<std::size_t>(frame.pixel_step_bytes)];
  return image;
}

FrameView frame_of(const Image& grey, std::size_t k) {
  return {grey.pixels.data(),
          grey.width,
          grey.height,
          static_cast<std::size_t>(grey.width),
          1,
          static_cast<std::int64_t>(k) * 33'333'333,
          static_cast<std::uint32_t>(k)};
}

Image to_grey(const Image& image) {
  if (image.channels == 1) return image;
  Image grey(image.width, image.height, 1);
  for (std::size_t i = 0; i < grey.pixels.size(); ++i) {
    const std::uint8_t* p = image.pixels.data() + 3 * i;
    grey.pixels[i] = static_cast<std::uint8_t>(luma(p[0], p[1], p[2]));
  }
  return grey;
}

Image to_colour(const Image& image) {
  if (image.channels == 3) return image;
  Image colour(image.width, image.height, 3);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    std::fill_n(colour.pixels.begin() + static_cast<std::ptrdiff_t>(3 * i), 3, image.pixels[i]);
  return colour;
}

Image enlarged(const Image& image, int factor) {
  Image out(image.width * factor, image.height * factor, image.channels);
  const float step = 1.0f / static_cast<float>(factor);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      const float sx = std::max(0.0f, (static_cast<float>(x) + 0.5f) * step - 0.5f);
      const float sy = std::max(0.0f, (static_cast<float>(y) + 0.5f) * step - 0.5f);
      const int x0 = static_cast<int>(sx), y0 = static_cast<int>(sy);
      const int x1 = std::min(x0 + 1, image.width - 1), y1 = std::min(y0 + 1, image.height - 1);
      const float fx = sx - static_cast<float>(x0), fy = sy - static_cast<float>(y0);
      for (int c = 0; c < image.channels; ++c) {
        const float top =
            static_cast<float>(image.at(x0, y0)[c]) * (1 - fx) + static_cast<float>(image.at(x1, y0)[c]) * fx;
        const float low =
            static_cast<float>(image.at(x0, y1)[c]) * (1 - fx) + static_cast<float>(image.at(x1, y1)[c]) * fx;
        out.at(x, y)[c] = static_cast<std::uint8_t>(top * (1 - fy) + low * fy + 0.5f);
      }
    }
  return out;
}

namespace {

/// The samples of a line that one of fewer is made of, and their weights.
struct Taps {
  int first = 0;
  std::vector<float> weight;
};

/// Catmull and Rom's kernel, two units to each side.
double cubic(double x) {
  x = std::abs(x);
  return x < 1 ? 1 + x * x * (1.5 * x - 2.5) : x < 2 ? 2 + x * (-4 + x * (2.5 - 0.5 * x)) : 0;
}

/// A kernel as wide as the new samples are apart keeps places, and more of the contrast than a mean, with which fewer small prints
/// are found (docs/experiments.md, Start by print).
std::vector<Taps> taps_of(int samples, int fewer) {
  std::vector<Taps> out(static_cast<std::size_t>(fewer));
  const double step = static_cast<double>(samples) / fewer;
  for (int k = 0; k < fewer; ++k) {
    Taps& taps = out[static_cast<std::size_t>(k)];
    const double centre = (k + 0.5) * step - 0.5;
    taps.first = std::max(0, static_cast<int>(std::ceil(centre - 2 * step)));
    const int last = std::min(samples - 1, static_cast<int>(std::floor(centre + 2 * step)));
    double sum = 0;
    for (int i = taps.first; i <= last; ++i) sum += cubic((i - centre) / step);
    for (int i = taps.first; i <= last; ++i)
      taps.weight.push_back(static_cast<float>(cubic((i - centre) / step) / sum));
  }
  return out;
}

std::uint8_t weighted(const Image& image, const Taps& columns, const Taps& rows, int channel) {
  float sum = 0;
  for (std::size_t j = 0; j < rows.weight.size(); ++j)
    for (std::size_t i = 0; i < columns.weight.size(); ++i)
      sum += rows.weight[j] * columns.weight[i] *
             static_cast<float>(
                 image.at(columns.first + static_cast<int>(i), rows.first + static_cast<int>(j))[channel]);
  return static_cast<std::uint8_t>(std::clamp(sum + 0.5f, 0.0f, 255.0f));
}

}  // namespace

Image shrunk_to(const Image& image, int width, int height) {
  const double scale =
      std::min({1.0, static_cast<double>(width) / image.width, static_cast<double>(height) / image.height});
  if (scale >= 1.0) return image;
  const auto side = [scale](int of) { return std::max(1, static_cast<int>(std::lround(of * scale))); };
  Image out(side(image.width), side(image.height), image.channels);
  const std::vector<Taps> columns = taps_of(image.width, out.width), rows = taps_of(image.height, out.height);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      for (int c = 0; c < image.channels; ++c)
        out.at(x, y)[c] =
            weighted(image, columns[static_cast<std::size_t>(x)], rows[static_cast<std::size_t>(y)], c);
  return out;
}

}  // namespace pliant::host
