#include "face/picture_noise.hpp"

#include <doctest/doctest.h>

#include "noisy_frame.hpp"
#include "vision/noise.hpp"
#include "vision/noise_tuning.hpp"

namespace picture_noise_test {

using namespace pliant;

namespace {

using Pixels = std::vector<std::uint8_t>;

/// Edges and a ramp, with noise, in a picture without padding.
Pixels picture(float sd, int side) {
  NoisyFrame frame(sd, side, side);
  Pixels out;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) out.push_back(frame.at(x, y));
  return out;
}

FrameNoise noise_of(const Pixels& pixels, int side) {
  return pliant::noise_of({pixels.data(), side, side, static_cast<std::size_t>(side)});
}

float ratio(const Pixels& pixels, int side) {
  const FrameNoise of = noise_of(pixels, side);
  return of.noise / of.contrast;
}

/// The weighted mean of 3 x 3 pixels, those of the border once more beyond it.
Pixels smoothed(const Pixels& pixels, int side) {
  Pixels out = pixels;
  const auto at = [&](int x, int y) {
    const int u = x < 0 ? 0 : x < side ? x : side - 1, v = y < 0 ? 0 : y < side ? y : side - 1;
    return int{pixels[static_cast<std::size_t>(v * side + u)]};
  };
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      int sum = 8;
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) sum += (i == 0 ? 2 : 1) * (j == 0 ? 2 : 1) * at(x + i, y + j);
      out[static_cast<std::size_t>(y * side + x)] = static_cast<std::uint8_t>(sum / 16);
    }
  return out;
}

Pixels after(Pixels pixels, int side) {
  smooth_noise(pixels.data(), side, kNoiseTuning.most_places);
  return pixels;
}

}  // namespace

TEST_CASE("a noisy picture is smoothed once, a very noisy one twice, a quiet one stays") {
  for (const int side : {160, 97, 32}) {
    CAPTURE(side);
    const Pixels quiet = picture(1, side), noisy = picture(6, side), very_noisy = picture(40, side);
    REQUIRE(ratio(noisy, side) > kPictureNoiseTuning.noisy);
    REQUIRE(ratio(noisy, side) < kPictureNoiseTuning.very_noisy);
    REQUIRE(ratio(very_noisy, side) > kPictureNoiseTuning.very_noisy);
    CHECK(after(quiet, side) == quiet);
    CHECK(after(noisy, side) == smoothed(noisy, side));
    CHECK(after(very_noisy, side) == smoothed(smoothed(very_noisy, side), side));
  }
}

TEST_CASE("the same noise is harmless in bright light and smoothed in low light") {
  constexpr int kSide = 160;
  const auto at_light = [](float light) {
    Pixels out = picture(0, kSide);
    Random random(5);
    for (std::uint8_t& p : out)
      p = static_cast<std::uint8_t>(
          clamp(20 + light * (static_cast<float>(p) - 80) + 2.5f * random.normal(), 0, 255));
    return out;
  };
  const Pixels bright = at_light(1.2f), dark = at_light(0.25f);
  CHECK(after(bright, kSide) == bright);
  CHECK(after(dark, kSide) != dark);
}

TEST_CASE("smoothing takes most of the noise and keeps the mean") {
  constexpr int kSide = 160;
  const Pixels noisy = picture(12, kSide), out = after(noisy, kSide);
  CHECK(noise_of(out, kSide).noise < 0.4f * noise_of(noisy, kSide).noise);
  double before = 0, now = 0;
  for (const std::uint8_t p : noisy) before += p;
  for (const std::uint8_t p : out) now += p;
  CHECK(now / before == doctest::Approx(1).epsilon(0.002));
}

TEST_CASE("steps of grey, and pictures too small to tell, are no noise") {
  Random random(3);
  Pixels steps(160 * 160);
  for (std::uint8_t& p : steps) p = static_cast<std::uint8_t>(100 + random.below(2));
  CHECK(after(steps, 160) == steps);
  for (const int side : {1, 2, 3, 17}) {
    const Pixels small = picture(40, side);
    CHECK(after(small, side) == small);
  }
  const Pixels least = picture(12, 18);
  CHECK(after(least, 18) != least);
}

}  // namespace picture_noise_test
