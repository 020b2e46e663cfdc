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

/// A pattern that repeats every `across` and `down` pixels, moved to the right and down.
std::vector<std::uint8_t> waves(float dx, float dy, float across = 10, float down = 10) {
  std::vector<std::uint8_t> out;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 80; ++x)
      out.push_back(
          static_cast<std::uint8_t>(128 + 100 * std::sin(6.2832f / across * (static_cast<float>(x) - dx)) *
                                              std::sin(6.2832f / down * (static_cast<float>(y) - dy))));
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

TEST_CASE("shifts up to the range are found each way, and none beyond it") {
  const Texture texture;
  const auto before = texture.image(40, 40);
  const PixelBox box{25, 18, 55, 44};
  for (const int range : {3, 6, 7, 8})
    for (const Vec2 way : {Vec2{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      CAPTURE(range);
      const Vec2 most = static_cast<float>(range) * way, beyond = static_cast<float>(range + 2) * way;
      const auto at_most = texture.image(40 - most.x, 40 - most.y),
                 farther = texture.image(40 - beyond.x, 40 - beyond.y);
      const CoarseTranslation s = find_coarse_translation(view(before), box, view(at_most), range);
      CHECK(length(s.by - most) < 0.15f);
      CHECK(s.correlation == doctest::Approx(1));
      const Vec2 by = find_coarse_translation(view(before), box, view(farther), range).by;
      CHECK(max(magnitude(by.x), magnitude(by.y)) <= static_cast<float>(range) + 0.5f);
    }
}

TEST_CASE("a shift counts if half of the box stays in the image, on each side of it") {
  const Texture texture;
  const auto before = texture.image(40, 40);
  const struct {
    PixelBox box;  // 20 x 20
    Vec2 way;
    int half;  // px, the shift by which half of the box leaves the image
  } kSides[] = {{{15, 20, 35, 40}, {-1, 0}, 25},
                {{45, 20, 65, 40}, {1, 0}, 25},
                {{30, 15, 50, 35}, {0, -1}, 25},
                {{30, 25, 50, 45}, {0, 1}, 25}};
  for (const auto& side : kSides)
    for (const int shift : {side.half, side.half + 1}) {
      CAPTURE(side.way.x);
      CAPTURE(side.way.y);
      const Vec2 by = static_cast<float>(shift) * side.way;
      const auto now = texture.image(40 - by.x, 40 - by.y);
      const CoarseTranslation s = find_coarse_translation(view(before), side.box, view(now), 27);
      CHECK((length(s.by - by) < 0.7f && magnitude(s.correlation - 1) < 1e-5f) == (shift == side.half));
    }
}

TEST_CASE("of equally good shifts the smaller one is taken") {
  // A pattern that repeats every 9 pixels: 3 and -6 are equally good, as -3 and 6 are.
  const auto pattern = [](int dx, int dy) {
    std::vector<std::uint8_t> out;
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < 80; ++x)
        out.push_back(
            static_cast<std::uint8_t>((x + 9 - dx) % 9 * 11 + (y + 9 - dy) % 9 * (y + 9 - dy) % 9 * 15));
    return out;
  };
  const auto before = pattern(0, 0);
  for (const int dx : {-3, 3})
    for (const int dy : {-3, 3}) {
      const auto now = pattern(dx, dy);
      const CoarseTranslation s = find_coarse_translation(view(before), {25, 18, 52, 45}, view(now), 9);
      CHECK(s.correlation == 1);
      CHECK(length(s.by - Vec2{static_cast<float>(dx), static_cast<float>(dy)}) < 0.5f);
    }
}

TEST_CASE("a ramp over the whole image is the same at every shift: none is found") {
  std::vector<std::uint8_t> ramp;
  for (int k = 0; k < 80 * 60; ++k) ramp.push_back(static_cast<std::uint8_t>(2 * (k % 80) + k / 80));
  const CoarseTranslation s = find_coarse_translation(view(ramp), {0, 0, 80, 60}, view(ramp), 0);
  CHECK(s.correlation == doctest::Approx(1));
  CHECK(length(s.by) < 0.01f);
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
  CHECK(find_coarse_translation(view(p), {10, 10, 40, 40}, {p.data(), 80, 59, 80}, 5).correlation == 0);
  CHECK(find_coarse_translation(view(p), {10, 10, 40, 40}, {nullptr, 80, 60, 80}, 5).correlation == 0);
  CHECK(find_coarse_translation(view(p), {40, 10, 10, 40}, view(p), 5).correlation == 0);
  CHECK(find_coarse_translation(view(p), {30, 10, 34, 14}, view(p), 5).correlation == doctest::Approx(1));
  CHECK(find_coarse_translation(view(p), {30, 10, 33, 14}, view(p), 5).compared_pixels == 0);
  CHECK(find_coarse_translation(view(p), {30, 10, 34, 13}, view(p), 5).compared_pixels == 0);
  CHECK(find_coarse_translation(view(p), {-100, -100, 500, 500}, view(p), 5).correlation ==
        doctest::Approx(1));
  CHECK(find_coarse_translation(view(p), {10, 10, 40, 40}, view(p), -1).correlation == 0);
}

TEST_CASE(
    "the widest and the highest image of a frame is compared without overflow, a larger one is refused") {
  for (const int width : {16384, 16385}) {
    std::vector<std::uint8_t> stripes(static_cast<std::size_t>(width) * 8, 255);
    for (std::size_t k = 0; k < stripes.size(); k += 3) stripes[k] = 0;
    for (const ImageView& image :
         {ImageView{stripes.data(), width, 8, width}, ImageView{stripes.data(), 8, width, 8}}) {
      const PixelBox all{0, 0, image.width, image.height};
      const float correlation = find_coarse_translation(image, all, image, 1).correlation;
      CHECK(correlation == doctest::Approx(width == 16384 ? 1.0 : 0.0));
    }
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

  std::vector<std::uint8_t> there(80 * 60, 0);  // what was 66 px to the right: farther than the image is high
  for (std::size_t k = 0; k < there.size(); ++k)
    if (k % 80 < 14) there[k] = before[k + 66];
  const CoarseTranslation far = find_coarse_translation(view(before), {64, 10, 80, 50}, view(there), 1000);
  CHECK(far.by.x == doctest::Approx(-66).epsilon(0.01));
  CHECK(far.correlation == doctest::Approx(1));
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
  const auto check = [&](Vec2 expected) {
    const CoarseTranslation s =
        find_coarse_translation(view(before), {25, 18, 55, 44}, view(now), 8, &expected);
    CHECK(length(s.by - Vec2{-5, 2}) < 0.15f);
  };
  for (int k = 0; k < 17 * 17; ++k) check({static_cast<float>(k % 17 - 8), static_cast<float>(k / 17 - 8)});
  check({-4.4f, 1.3f});
  check({1e30f, -1e30f});
}

TEST_CASE("a slope that rises for longer than is climbed is no peak: the best shift is taken") {
  const auto before = waves(0, 0, 40, 40), now = waves(-5, 2, 40, 40);
  for (const Vec2 expected : {Vec2{0, 0}, {-1, -3}, {-8, 8}}) {
    const CoarseTranslation s =
        find_coarse_translation(view(before), {25, 18, 55, 44}, view(now), 8, &expected);
    CHECK(length(s.by - Vec2{-5, 2}) < 0.3f);
  }
}

TEST_CASE(
    "the peak next to the expected shift is taken, as its nearest whole shift has it, within the range") {
  std::vector<std::uint8_t> stripes;  // a pattern that repeats every 3 pixels
  for (int k = 0; k < 80 * 60; ++k) stripes.push_back(static_cast<std::uint8_t>(100 * (k % 80 % 3)));
  const auto found_at = [&](float expected) {
    const Vec2 at{expected, 0};
    return find_coarse_translation(view(stripes), {25, 18, 55, 44}, view(stripes), 6, &at).by.x;
  };
  CHECK(found_at(1.4f) == 0);
  CHECK(found_at(1.6f) == 3);
  CHECK(found_at(-1.4f) == 0);
  CHECK(found_at(-1.6f) == -3);
  CHECK(found_at(4.6f) == 6);
  CHECK(found_at(21) == 6);
  CHECK(found_at(-1e30f) == -6);
}

TEST_CASE("a peak between two pixels is as high as one at a pixel") {
  for (const bool is_across : {true, false}) {
    CAPTURE(is_across);
    const auto wave = [&](float d) { return is_across ? waves(d, 0, 5.5f, 20) : waves(0, d, 20, 5.5f); };
    const auto before = wave(0), now = wave(0.5f);  // and 6: a whole pixel
    const Vec2 expected;
    const CoarseTranslation s =
        find_coarse_translation(view(before), {25, 18, 55, 44}, view(now), 7, &expected);
    CHECK(length(s.by - (is_across ? Vec2{0.5f, 0} : Vec2{0, 0.5f})) < 0.1f);
  }
}

TEST_CASE("a peak between two pixels is not taken where it is clearly lower: the pattern does not repeat") {
  const Texture texture;
  const auto image = [&](float d) {
    std::vector<std::uint8_t> out;
    for (int k = 0; k < 80 * 60; ++k) {
      const float x = static_cast<float>(k % 80) - d, y = static_cast<float>(k / 80);
      out.push_back(static_cast<std::uint8_t>(128 + 50 * std::sin(6.2832f / 5.5f * x) +
                                              0.45f * (texture.at(40 + x, 40 + y) - 127)));
    }
    return out;
  };
  const auto before = image(0), now = image(6);
  const Vec2 expected;
  const CoarseTranslation s =
      find_coarse_translation(view(before), {25, 18, 55, 44}, view(now), 7, &expected);
  CHECK(length(s.by - Vec2{6, 0}) < 0.1f);
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
