#include "vision/thumbnail.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <numeric>
#include <vector>

#include "texture.hpp"

namespace thumbnail_test {

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

TEST_CASE("levelled rows have one mean, and no longer the gain that each had of its own") {
  constexpr int kColumns = 64, kRows = 32;
  const Picture p = texture::noise(kColumns, kRows, 5);
  std::vector<std::uint8_t> even(p.pixels.size()), banded(p.pixels.size());
  for (std::size_t k = 0; k < even.size(); ++k) {
    even[k] = static_cast<std::uint8_t>(40 + p.pixels[k] / 4);
    banded[k] =
        static_cast<std::uint8_t>(even[k] * (1 + 0.5 * std::sin(0.4 * static_cast<double>(k / kColumns))));
  }
  level_rows(even.data(), kColumns, kRows);
  level_rows(banded.data(), kColumns, kRows);
  for (std::size_t y = 0; y < kRows; ++y) {
    const auto row = even.begin() + static_cast<std::ptrdiff_t>(y * kColumns);
    CHECK(std::accumulate(row, row + kColumns, 0) / double(kColumns) == doctest::Approx(96).epsilon(0.02));
  }
  for (std::size_t k = 0; k < even.size(); ++k) CHECK(std::abs(even[k] - banded[k]) <= 12);
}

TEST_CASE("rows that are black, white, of one pixel or of the largest width are levelled without overflow") {
  for (const int columns : {1, 2, 96, 16384})
    for (const std::uint8_t grey : {std::uint8_t{0}, std::uint8_t{1}, std::uint8_t{255}}) {
      std::vector<std::uint8_t> row(static_cast<std::size_t>(columns), grey);
      level_rows(row.data(), columns, 1);
      for (const std::uint8_t p : row) REQUIRE(std::abs(p - 96) <= 1);
    }
  std::vector<std::uint8_t> one(96, 0);
  one[7] = 255;
  level_rows(one.data(), 96, 1);
  CHECK(one[7] == 255);
  level_rows(one.data(), 96, 0);  // nothing
}

}  // namespace thumbnail_test
