#include "pliant/coarse_translation.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "random.hpp"
#include "vision/coarse_translation_tuning.hpp"

namespace coarse_translation_test {

using namespace pliant;

namespace {

/// Smooth random texture, seen through a window that can be moved by whole and half pixels.
struct Texture {
  std::vector<float> value;
  static constexpr int kSide = 160;
  Texture() : value(kSide * kSide) {
    Random random(2);
    std::vector<float> raw(value.size());
    for (float& v : raw) v = random.uniform(0, 255);
    for (int y = 3; y < kSide - 3; ++y)
      for (int x = 3; x < kSide - 3; ++x) {
        float sum = 0;
        for (int j = -3; j <= 3; ++j)
          for (int i = -3; i <= 3; ++i) sum += raw[static_cast<std::size_t>((y + j) * kSide + x + i)];
        value[static_cast<std::size_t>(y * kSide + x)] = 4 * (sum / 49 - 127) + 127;
      }
  }
  float at(float x, float y) const {
    const int i = static_cast<int>(x), j = static_cast<int>(y);
    const float a = x - static_cast<float>(i), b = y - static_cast<float>(j);
    const auto v = [&](int k, int l) { return value[static_cast<std::size_t>((j + l) * kSide + i + k)]; };
    return (1 - b) * ((1 - a) * v(0, 0) + a * v(1, 0)) + b * ((1 - a) * v(0, 1) + a * v(1, 1));
  }
  std::vector<std::uint8_t> image(float left, float top, float gain = 1) const {
    std::vector<std::uint8_t> out;
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < 80; ++x)
        out.push_back(static_cast<std::uint8_t>(
            clamp(gain * at(left + static_cast<float>(x), top + static_cast<float>(y)) + 0.5f, 0, 255)));
    return out;
  }
};

/// A pattern that repeats every 10 pixels, moved to the right and down.
std::vector<std::uint8_t> waves(float dx, float dy) {
  std::vector<std::uint8_t> out;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 80; ++x)
      out.push_back(static_cast<std::uint8_t>(128 + 100 * std::sin(0.6283f * (static_cast<float>(x) - dx)) *
                                                        std::sin(0.6283f * (static_cast<float>(y) - dy))));
  return out;
}

ImageView view(const std::vector<std::uint8_t>& p) {
  return {p.data(), 80, 60, 80};
}

}  // namespace

TEST_CASE("a moved image gives its shift, in whole and half pixels and with another gain") {
  const Texture texture;
  const auto before = texture.image(40, 40);
  const PixelBox box{25, 18, 55, 44};
  for (float dx : {-7.0f, -0.5f, 0.0f, 3.5f})
    for (float dy : {-6.0f, 0.0f, 2.5f}) {
      const auto now = texture.image(40 - dx, 40 - dy, 0.8f);
      const CoarseTranslation s = find_coarse_translation(view(before), box, view(now), 8);
      CHECK(s.by.x == doctest::Approx(double(dx)).epsilon(0.05).scale(4));
      CHECK(s.by.y == doctest::Approx(double(dy)).epsilon(0.05).scale(4));
      CHECK(s.correlation > 0.9f);
    }
}

TEST_CASE("nothing to compare gives no shift") {
  const std::vector<std::uint8_t> flat(80 * 60, 90);
  const CoarseTranslation s = find_coarse_translation(view(flat), {10, 10, 40, 40}, view(flat), 5);
  CHECK(s.correlation == 0);
  CHECK(length(s.by) == 0);
  const Texture texture;
  const auto p = texture.image(40, 40);
  CHECK(find_coarse_translation({}, {10, 10, 40, 40}, view(p), 5).correlation == 0);
  CHECK(find_coarse_translation(view(p), {10, 10, 40, 40}, {p.data(), 40, 60, 80}, 5).correlation == 0);
  CHECK(find_coarse_translation(view(p), {40, 10, 10, 40}, view(p), 5).correlation == 0);
  CHECK(find_coarse_translation(view(p), {-100, -100, 500, 500}, view(p), 5).correlation ==
        doctest::Approx(1));
  CHECK(find_coarse_translation(view(p), {10, 10, 40, 40}, view(p), -1).correlation == 0);
}

TEST_CASE("the widest image of a frame is compared without overflow, a wider one is refused") {
  for (const int width : {16384, 16385}) {
    std::vector<std::uint8_t> stripes(static_cast<std::size_t>(width) * 8, 255);
    for (std::size_t k = 0; k < stripes.size(); k += 3) stripes[k] = 0;
    const ImageView image{stripes.data(), width, 8, width};
    const float correlation = find_coarse_translation(image, {0, 0, width, 8}, image, 1).correlation;
    CHECK(correlation == doctest::Approx(width == 16384 ? 1.0 : 0.0));
  }
}

TEST_CASE("a box that is far outside, or turned inside out, gives nothing; a huge one is clipped") {
  const Texture texture;
  const auto p = texture.image(40, 40);
  constexpr int kMost = std::numeric_limits<int>::max(), kLeast = std::numeric_limits<int>::min();
  const CoarseTranslation whole = find_coarse_translation(view(p), {0, 0, 80, 60}, view(p), 2),
                          huge = find_coarse_translation(view(p), {kLeast, kLeast, kMost, kMost}, view(p), 2);
  CHECK(huge.correlation == whole.correlation);
  CHECK(huge.compared_pixels == whole.compared_pixels);
  for (const PixelBox& box : {PixelBox{kMost, 0, kMost, 60},
                              {kLeast, 0, kLeast, 60},
                              {kMost, kMost, kLeast, kLeast},
                              {0, kMost, 80, kLeast},
                              {kMost, 0, kLeast, 60}})
    CHECK(find_coarse_translation(view(p), box, view(p), 2).compared_pixels == 0);
}

TEST_CASE("a range beyond the image is as good as its larger side, and as fast") {
  const Texture texture;
  const auto before = texture.image(40, 40), now = texture.image(33, 44);
  const PixelBox box{25, 18, 55, 44};
  const CoarseTranslation side = find_coarse_translation(view(before), box, view(now), 80),
                          most = find_coarse_translation(view(before), box, view(now), 2'000'000'000);
  CHECK(most.by.x == side.by.x);
  CHECK(most.by.y == side.by.y);
  CHECK(most.compared_pixels == side.compared_pixels);
  CHECK(most.by.x == doctest::Approx(7).epsilon(0.05));
}

TEST_CASE("of the shifts of a pattern that repeats the one near the expected shift is taken") {
  const auto before = waves(0, 0);
  const PixelBox box{25, 18, 55, 44};
  for (const Vec2 expected : {Vec2{0, 0}, {3, -1}, {12, 0}, {-9, 9}})
    for (const Vec2 off : {Vec2{0, 0}, {1.4f, 0.3f}, {-0.5f, -1.5f}}) {
      const Vec2 shift = expected + off;
      const auto now = waves(shift.x, shift.y);
      const CoarseTranslation s = find_coarse_translation(view(before), box, view(now), 15, &expected);
      CHECK(length(s.by - shift) < 0.15f);
      CHECK(s.correlation > 0.8f);
    }
}

TEST_CASE("where nothing repeats the best shift is taken, wherever it is expected") {
  const Texture texture;
  const auto before = texture.image(40, 40), now = texture.image(45, 38);
  for (const Vec2 expected : {Vec2{0, 0}, {-5, 2}, {-4.4f, 1.3f}, {6, -6}, {1e30f, -1e30f}}) {
    const CoarseTranslation s =
        find_coarse_translation(view(before), {25, 18, 55, 44}, view(now), 8, &expected);
    CHECK(length(s.by - Vec2{-5, 2}) < 0.15f);
  }
}

TEST_CASE("no search compares more pixels than the bound that `pliant plan` prints") {
  const Texture texture;
  const auto before = texture.image(40, 40), now = texture.image(37, 42);
  const PixelBox box{25, 18, 45, 34};
  const auto pixels = static_cast<std::uint32_t>((box.x1 - box.x0) * (box.y1 - box.y0));
  for (int range = 0; range < 12; ++range) {
    const std::uint32_t compared =
        find_coarse_translation(view(before), box, view(now), range).compared_pixels;
    const Vec2 expected{8, 8};
    CHECK(compared <= pixels * static_cast<std::uint32_t>(most_shifts(range)));
    CHECK(find_coarse_translation(view(before), box, view(now), range, &expected).compared_pixels <=
          pixels * static_cast<std::uint32_t>(most_shifts(range) + kMostExpectedShifts));
    CHECK(compared > 0);
  }
}

}  // namespace coarse_translation_test
