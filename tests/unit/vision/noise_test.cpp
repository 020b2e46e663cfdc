#include "vision/noise.hpp"

#include <doctest/doctest.h>

#include "noisy_frame.hpp"
#include "vision/noise_tuning.hpp"

namespace noise_test {

using namespace pliant;

namespace {

constexpr int kWidth = 160, kHeight = 120;

}  // namespace

TEST_CASE("noise is measured to a tenth, or half a grey level, whatever ramps and edges are below") {
  for (const float sd : {0.0f, 2.0f, 4.0f, 7.0f, 12.0f, 25.0f}) {
    CAPTURE(sd);
    const float noise = noise_of(NoisyFrame(sd).view()).noise;
    CHECK(noise > 0.9f * sd - 0.5f);
    CHECK(noise < 1.1f * sd + 0.5f);
  }
  CHECK(noise_of(NoisyFrame(7, 640, 480).view()).noise == doctest::Approx(7).epsilon(0.1));
  CHECK(noise_of(NoisyFrame(7, kWidth, kHeight, 2).view()).noise == doctest::Approx(7).epsilon(0.1));
}

TEST_CASE(
    "noise is measured at no more places than are stated, and at half of them or more in large frames") {
  for (int width = 1; width < 4000; width += 7)
    for (int height = 1; height < 2000; height += 13) {
      const int step = noise_step(width, height),
                places = noise_places(width, step) * noise_places(height, step);
      CAPTURE(width);
      CAPTURE(height);
      REQUIRE(step % 2 == 1);
      REQUIRE(places <= kNoiseTuning.most_places);
      if (width > 400 && height > 300) REQUIRE(2 * places > kNoiseTuning.most_places);
    }
}

TEST_CASE("places are those with neighbours, a step apart; what lies between them is not measured") {
  for (int side = 0; side < 40; ++side)
    for (const int step : {1, 3, 5, 7}) {
      int places = 0;
      for (int x = 1; x + 1 < side; x += step) ++places;
      CHECK(noise_places(side, step) == places);
    }
  for (const bool is_across : {false, true}) {
    NoisyFrame between(0, 640, 480), clean(0, 640, 480);
    const int step = noise_step(640, 480);
    REQUIRE(step > 3);
    Random random(4);
    for (int y = 0; y < 480; ++y)
      for (int x = 0; x < 640; ++x)
        if ((is_across ? x : y) % step > 2)
          between.at(x, y) = static_cast<std::uint8_t>(between.at(x, y) + random.below(40));
    CHECK(noise_of(between.view()).noise == noise_of(clean.view()).noise);
  }
}

TEST_CASE("fewer places tell the noise of a small picture, less exactly") {
  for (const int most : {4096, 512}) {
    const int step = noise_step(46, 46, most);
    CHECK(step == (most == 512 ? 3 : 1));
    const NoisyFrame frame(7, 46, 46);
    CHECK(noise_of(frame.view(), most).noise == doctest::Approx(7).epsilon(0.2));
  }
  const NoisyFrame tiny(7, 7, 7);
  CHECK(noise_of(tiny.view(), 512).noise == 0);  // 25 places
  CHECK(noise_of(tiny.view(), 256).noise > 3);
}

TEST_CASE("places that are clipped, black or white, do not count") {
  for (const int clipped : {0, 255}) {
    CAPTURE(clipped);
    NoisyFrame frame(8);
    for (int y = 0; y < kHeight * 6 / 10; ++y)
      for (int x = 0; x < kWidth; ++x) frame.at(x, y) = static_cast<std::uint8_t>(clipped);
    CHECK(noise_of(frame.view()).noise == doctest::Approx(8).epsilon(0.1));
    CHECK(noise_of(frame.view()).contrast < 30);
  }
}

TEST_CASE("where nothing can be measured there is no noise") {
  CHECK(noise_of(NoisyFrame(7, 1, 1).view()).noise == 0);
  CHECK(noise_of(NoisyFrame(7, 10, 10).view()).noise == 0);
  CHECK(noise_of(NoisyFrame(7, 17, 18).view()).noise == 0);
  CHECK(noise_of(NoisyFrame(7, 18, 18).view()).noise > 4);                    // 256 places
  CHECK(noise_of(NoisyFrame(9, kWidth, kHeight, 1, 400).view()).noise == 0);  // white
}

}  // namespace noise_test
