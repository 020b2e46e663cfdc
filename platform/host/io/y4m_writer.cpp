#include "host/io/y4m_writer.hpp"

#include <algorithm>
#include <cstdint>

#include "host/io/failure.hpp"
#include "host/io/sources.hpp"

namespace pliant::host {
namespace {

struct Sum {
  int r = 0, g = 0, b = 0;
};

// Sum of the 2 x 2 pixels at (x, y), the last row and column repeated where the size is odd.
Sum sum_of_block(const std::uint8_t* rgb, int width, int height, int x, int y) {
  Sum s;
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const int px = x + i < width ? x + i : width - 1, py = y + j < height ? y + j : height - 1;
      const std::uint8_t* p = rgb + 3 * (static_cast<std::ptrdiff_t>(py) * width + px);
      s.r += p[0];
      s.g += p[1];
      s.b += p[2];
    }
  return s;
}

// 128 + sum / 4 for weights in thousandths; the sum is within +-127.5 * 4.
std::uint8_t chroma(int weighted) {
  const int v = (weighted + 4 * 128 * 1000 + 2000) / 4000;
  return static_cast<std::uint8_t>(v > 255 ? 255 : v);
}

}  // namespace

void Y4mWriter::begin(const Image& first) {
  const auto is_side = [](int pixels) { return pixels >= 1 && pixels <= kMaxFrameSide; };
  if (!is_side(first.width) || !is_side(first.height))
    fail_input(file_.name(), "a frame of an impossible size");
  size_ = {first.width, first.height};
  is_grey_ = first.channels == 1;
  const auto luma = static_cast<std::size_t>(size_.width) * static_cast<std::size_t>(size_.height);
  const auto quarter =
      static_cast<std::size_t>((size_.width + 1) / 2) * static_cast<std::size_t>((size_.height + 1) / 2);
  frame_.resize(luma + (is_grey_ ? 0 : 2 * quarter));
  file_.write("YUV4MPEG2 W" + std::to_string(size_.width) + " H" + std::to_string(size_.height) + " F" +
              std::to_string(rate_.numerator) + ":" + std::to_string(rate_.denominator) + " Ip A1:1 C" +
              (is_grey_ ? "mono" : "420jpeg") + " XCOLORRANGE=FULL\n");
}

void Y4mWriter::write(const Image& image) {
  if (size_.width == 0) begin(image);
  if (image.width != size_.width || image.height != size_.height || (image.channels == 1) != is_grey_)
    fail_input(file_.name(), "a frame differs in size or kind from the first");
  const auto n = static_cast<std::size_t>(size_.width) * static_cast<std::size_t>(size_.height);
  const std::uint8_t* p = image.pixels.data();
  if (is_grey_)
    std::copy(p, p + n, frame_.begin());
  else
    for (std::size_t i = 0; i < n; ++i, p += 3) frame_[i] = static_cast<char>(luma(p[0], p[1], p[2]));
  if (!is_grey_) set_chroma(image);
  file_.write("FRAME\n" + frame_);
}

// Cb = -0.168736 R - 0.331264 G + 0.5 B and Cr = 0.5 R - 0.418688 G - 0.081312 B, of the mean of 2 x 2 pixels.
void Y4mWriter::set_chroma(const Image& image) {
  const int w = size_.width, h = size_.height, cw = (w + 1) / 2, ch = (h + 1) / 2;
  char* cb = frame_.data() + static_cast<std::ptrdiff_t>(w) * h;
  char* cr = cb + static_cast<std::ptrdiff_t>(cw) * ch;
  for (int y = 0; y < ch; ++y)
    for (int x = 0; x < cw; ++x) {
      const Sum s = sum_of_block(image.pixels.data(), w, h, 2 * x, 2 * y);
      *cb++ = static_cast<char>(chroma(-169 * s.r - 331 * s.g + 500 * s.b));
      *cr++ = static_cast<char>(chroma(500 * s.r - 419 * s.g - 81 * s.b));
    }
}

}  // namespace pliant::host
