#include "face/scaled_lines.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "texture.hpp"

namespace scaled_lines_test {

using namespace pliant;
using texture::Picture;

namespace {

std::vector<std::uint8_t> read(const ScaledLines& lines, int x, int y, int count) {
  std::vector<std::uint8_t> out(static_cast<std::size_t>(count));
  std::vector<std::uint32_t> scratch(out.size());
  lines.read(x, y, count, scratch.data(), out.data());
  return out;
}

// The mean over the area [x r, (x + 1) r) x [y r, (y + 1) r), in the plainest way.
double mean_of(Picture& p, int x, int y, double r) {
  const auto part = [r](int pixel, int at) {
    return std::max(0.0, std::min(pixel + 1.0, (at + 1) * r) - std::max<double>(pixel, at * r));
  };
  double sum = 0;
  for (int j = static_cast<int>(y * r); j < (y + 1) * r && j < p.height; ++j)
    for (int i = static_cast<int>(x * r); i < (x + 1) * r && i < p.width; ++i)
      sum += part(i, x) * part(j, y) * p.at(i, j);
  return sum / (r * r);
}

}  // namespace

TEST_CASE("a pixel is the mean over the area that it covers, at ratios from 1 to 4") {
  Picture p = texture::noise(61, 47, 11);
  for (const int ratio : {256, 304, 362, 431, 512, 600, 768, 1023}) {
    CAPTURE(ratio);
    const ScaledLines lines(p.frame(), ratio);
    CHECK(lines.width() == 61 * 256 / ratio);
    for (int y = 0; y < lines.height(); ++y) {
      const auto line = read(lines, 0, y, lines.width());
      for (int x = 0; x < lines.width(); ++x)
        REQUIRE(std::abs(line[static_cast<std::size_t>(x)] - mean_of(p, x, y, ratio / 256.0)) < 0.6);
    }
  }
}

TEST_CASE("above a ratio of 4 a pixel is the mean of 16 pixels of its area") {
  Picture p(300, 200);
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 300; ++x) p.at(x, y) = static_cast<std::uint8_t>((x + y) / 2);
  for (const int ratio : {1024, 1300, 5000}) {
    const ScaledLines lines(p.frame(), ratio);
    const auto line = read(lines, 0, 1, lines.width());
    for (int x = 0; x < lines.width(); ++x)
      CHECK(std::abs(line[static_cast<std::size_t>(x)] - mean_of(p, x, 1, ratio / 256.0)) <
            0.1 * ratio / 256 + 1);
  }
}

TEST_CASE("beyond its border the picture repeats its border pixels, wherever the reading begins and ends") {
  const Picture p = texture::noise(50, 40, 11);
  for (const int ratio : {256, 362, 1100}) {
    const ScaledLines lines(p.frame(), ratio);
    const int w = lines.width();
    for (const int y : {-9, 0, lines.height() - 1, lines.height() + 7}) {
      const auto inside = read(lines, 0, std::clamp(y, 0, lines.height() - 1), w);
      for (const int x : {-30, -5, 0, 3, w - 1, w + 4})
        for (const int count : {1, 7, 60}) {
          const auto line = read(lines, x, y, count);
          for (int k = 0; k < count; ++k)
            REQUIRE(line[static_cast<std::size_t>(k)] ==
                    inside[static_cast<std::size_t>(std::clamp(x + k, 0, w - 1))]);
        }
    }
  }
}

TEST_CASE("white stays white and black black at every ratio") {
  for (const std::uint8_t grey : {std::uint8_t{0}, std::uint8_t{255}}) {
    const Picture p(40, 40, grey);
    for (int ratio = 256; ratio < 1100; ++ratio)
      for (const std::uint8_t v : read(ScaledLines(p.frame(), ratio), -2, 3, 12)) REQUIRE(v == grey);
  }
}

}  // namespace scaled_lines_test
