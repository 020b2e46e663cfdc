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
    grey.pixels[i] = static_cast<std::uint8_t>((77 * p[0] + 150 * p[1] + 29 * p[2] + 128) / 256);
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

/// The samples of a line that one of fewer covers, and the parts of it that they are.
struct Cover {
  int first = 0;
  std::vector<float> part;
};

std::vector<Cover> covers(int samples, int fewer) {
  std::vector<Cover> out(static_cast<std::size_t>(fewer));
  const double step = static_cast<double>(samples) / fewer;
  for (int k = 0; k < fewer; ++k) {
    const double low = k * step, high = k + 1 == fewer ? samples : low + step;
    Cover& cover = out[static_cast<std::size_t>(k)];
    cover.first = static_cast<int>(low);
    for (int i = cover.first; i < samples && i < high; ++i)
      cover.part.push_back(static_cast<float>((std::min(high, i + 1.0) - std::max<double>(low, i)) / step));
  }
  return out;
}

std::uint8_t covered_mean(const Image& image, const Cover& columns, const Cover& rows, int channel) {
  float sum = 0;
  for (std::size_t j = 0; j < rows.part.size(); ++j)
    for (std::size_t i = 0; i < columns.part.size(); ++i)
      sum += rows.part[j] * columns.part[i] *
             static_cast<float>(
                 image.at(columns.first + static_cast<int>(i), rows.first + static_cast<int>(j))[channel]);
  return static_cast<std::uint8_t>(std::min(sum + 0.5f, 255.0f));
}

}  // namespace

Image shrunk_to(const Image& image, int width, int height) {
  const double scale =
      std::min({1.0, static_cast<double>(width) / image.width, static_cast<double>(height) / image.height});
  if (scale >= 1.0) return image;
  const auto side = [scale](int of) { return std::max(1, static_cast<int>(std::lround(of * scale))); };
  Image out(side(image.width), side(image.height), image.channels);
  const std::vector<Cover> columns = covers(image.width, out.width), rows = covers(image.height, out.height);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      for (int c = 0; c < image.channels; ++c)
        out.at(x, y)[c] =
            covered_mean(image, columns[static_cast<std::size_t>(x)], rows[static_cast<std::size_t>(y)], c);
  return out;
}

}  // namespace pliant::host
