#include "vision/thumbnail.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "texture.hpp"

using namespace pliant;
using texture::Picture;

namespace {

std::vector<std::uint8_t> thumbnail_of(const FrameView& frame, int factor) {
  const int columns = frame.width / factor, rows = frame.height / factor;
  std::vector<std::uint16_t> line(static_cast<std::size_t>(columns * factor));
  std::vector<std::uint8_t> out(static_cast<std::size_t>(columns * rows));
  make_thumbnail(frame, factor, line.data(), out.data());
  return out;
}

}  // namespace

TEST_CASE("the factor is the smallest power of two that leaves at most so many columns") {
  CHECK(thumbnail_factor(320, 40) == 8);
  CHECK(thumbnail_factor(320, 320) == 1);
  CHECK(thumbnail_factor(321, 320) == 2);
  CHECK(thumbnail_factor(640, 40) == 16);
  CHECK(thumbnail_factor(16384, 40) == 64);  // at most
}

TEST_CASE(
    "a pixel is the rounded mean of its block over every other row, and incomplete blocks are left out") {
  const Picture p = texture::noise(45, 38, 3);
  for (const int factor : {1, 2, 4, 8, 16}) {
    CAPTURE(factor);
    const std::vector<std::uint8_t> small = thumbnail_of(p.frame(), factor);
    const int columns = 45 / factor, rows = 38 / factor, step = factor > 1 ? 2 : 1;
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < columns; ++x) {
        int sum = 0, count = 0;
        for (int j = 0; j < factor; j += step)
          for (int i = 0; i < factor; ++i, ++count)
            sum += p.pixels[static_cast<std::size_t>((y * factor + j) * 45 + x * factor + i)];
        REQUIRE(small[static_cast<std::size_t>(y * columns + x)] == (sum + count / 2) / count);
      }
  }
}

TEST_CASE("the largest factor does not overflow on white") {
  for (const std::uint8_t grey : thumbnail_of(Picture(128, 64, 255).frame(), 64)) CHECK(grey == 255);
}

TEST_CASE("a packed frame and one with padded rows give the thumbnail of their luma") {
  const Picture p = texture::noise(40, 24, 3);
  const std::size_t stride = 40 * 2 + 6;
  std::vector<std::uint8_t> packed(stride * 24, 99), padded(50 * 24, 99);
  for (std::size_t y = 0; y < 24; ++y)
    for (std::size_t x = 0; x < 40; ++x) {
      packed[y * stride + 2 * x] = p.pixels[y * 40 + x];
      padded[y * 50 + x] = p.pixels[y * 40 + x];
    }
  FrameView a = p.frame(), b = p.frame();
  a.data = packed.data();
  a.stride_bytes = stride;
  a.pixel_step_bytes = 2;
  b.data = padded.data();
  b.stride_bytes = 50;
  CHECK(thumbnail_of(a, 4) == thumbnail_of(p.frame(), 4));
  CHECK(thumbnail_of(b, 4) == thumbnail_of(p.frame(), 4));
}
