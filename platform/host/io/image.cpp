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

Image shrunk_to(const Image& image, int width, int height) {
  const double scale =
      std::min({1.0, static_cast<double>(width) / image.width, static_cast<double>(height) / image.height});
  if (scale >= 1.0) return image;
  Image out(std::max(1, static_cast<int>(image.width * scale)),
            std::max(1, static_cast<int>(image.height * scale)), image.channels);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      const int x0 = x * image.width / out.width, x1 = std::max(x0 + 1, (x + 1) * image.width / out.width);
      const int y0 = y * image.height / out.height,
                y1 = std::max(y0 + 1, (y + 1) * image.height / out.height);
      for (int c = 0; c < image.channels; ++c) {
        int sum = 0;
        for (int j = y0; j < y1; ++j)
          for (int i = x0; i < x1; ++i) sum += image.at(i, j)[c];
        const int count = (x1 - x0) * (y1 - y0);
        out.at(x, y)[c] = static_cast<std::uint8_t>((sum + count / 2) / count);
      }
    }
  return out;
}

}  // namespace pliant::host
