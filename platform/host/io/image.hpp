#pragma once
/// \file image.hpp
/// Pictures of the host tools: 8 bits a channel, grey or colour, rows from the top without padding.
#include <cstdint>
#include <string>
#include <vector>

#include "pliant/frame.hpp"

namespace pliant::host {

/// Pixels.
struct ImageSize {
  int width = 0, height = 0;
};

struct Colour {
  std::uint8_t r = 0, g = 0, b = 0;
};

/// One channel (grey) or three (red, green, blue, interleaved).
struct Image {
  int width = 0, height = 0, channels = 1;
  std::vector<std::uint8_t> pixels;

  Image() = default;
  Image(int w, int h, int c, std::uint8_t value = 0)
      : width(w),
        height(h),
        channels(c),
        pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h) * static_cast<std::size_t>(c),
               value) {}

  std::uint8_t* at(int x, int y) { return pixels.data() + offset(x, y); }
  const std::uint8_t* at(int x, int y) const { return pixels.data() + offset(x, y); }
  bool contains(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }

 private:
  std::size_t offset(int x, int y) const {
    return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) *
           static_cast<std::size_t>(channels);
  }
};

/// Luma of a colour (Rec. 601), in the unit of its channels, 0 to 65,535; rounded.
constexpr int luma(int r, int g, int b) {
  return (299 * r + 587 * g + 114 * b + 500) / 1000;
}

/// A grey copy of a frame.
Image image_of(const FrameView& frame);
/// A view of a grey picture, which must outlive it, as frame k of a film of 30 frames a second.
FrameView frame_of(const Image& grey, std::size_t k = 0);
/// Luma of a colour picture; a copy of a grey one.
Image to_grey(const Image& image);
/// Three equal channels of a grey picture; a copy of a colour one.
Image to_colour(const Image& image);
/// Enlarges a picture by an integer factor, bilinearly.
Image enlarged(const Image& image, int factor);
/// Shrinks a picture by cubic convolution to at most `width` x `height` pixels, with its proportions; a copy if it fits already.
Image shrunk_to(const Image& image, int width, int height);

/// Reads JPEG, PNG, and PGM and PPM of 8 bits, of at most 16,384 pixels a side and 100 million in all as colour. A JPEG is
/// turned as its camera was held. Bad input otherwise.
Image read_image(const std::string& path);
/// The same of the bytes of that file.
Image image_in(const std::string& path, const std::string& bytes);
/// The bytes of a PNG file.
std::string encode_png(const Image& image);
/// The bytes of a JPEG file. \param quality  1 to 100.
std::string encode_jpeg(const Image& image, int quality);

}  // namespace pliant::host
