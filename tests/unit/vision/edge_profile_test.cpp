#include "vision/edge_profile.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "texture.hpp"

namespace edge_profile_test {

using namespace pliant;
using texture::Picture;

TEST_CASE("a step of the image is a derivative of the stated size, of the sign of the normal") {
  Picture p(64, 64, 50);
  for (int y = 0; y < 64; ++y)
    for (int x = 32; x < 64; ++x) p.at(x, y) = 90;
  EdgeProfile profile;
  for (const float sign : {1.0f, -1.0f}) {
    sample_profile(p.view(), {30, 32}, {sign, 0}, 8, profile);
    REQUIRE(profile.count > 0);
    int largest = 0;
    for (int i = 0; i < profile.count; ++i)
      if (std::abs(profile.derivative[i]) > std::abs(profile.derivative[largest])) largest = i;
    CHECK(profile.derivative[largest] == static_cast<int>(sign) * 3 * kProfileLines * kProfileGreyScale * 40);
    // Between the pixels 31 and 32: one or two steps along the normal.
    const int at = static_cast<int>(sign) * (profile.first + largest);
    CHECK((at == 1 || at == 2));
    CHECK(profile.noise == 0);
  }
}

TEST_CASE("the profile ends where the image does, and is empty where not even its middle fits") {
  const Picture p(64, 64, 50);
  EdgeProfile profile;
  sample_profile(p.view(), {32, 32}, {1, 0}, 16, profile);
  CHECK(profile.first == -17);
  CHECK(profile.count == 35);
  sample_profile(p.view(), {5, 32}, {1, 0}, 16, profile);
  CHECK(profile.first == -3);
  sample_profile(p.view(), {2, 32}, {1, 0}, 16, profile);
  CHECK(profile.count == 0);
  sample_profile(p.view(), {32, 1}, {1, 0}, 16, profile);  // the strip is five samples wide
  CHECK(profile.count == 0);
}

TEST_CASE("the noise of an even image is measured, and amplified as stated") {
  texture::Random random(7);
  double measured = 0, derivative = 0;
  int profiles = 0, steps = 0;
  for (int round = 0; round < 60; ++round) {
    Picture p(64, 64);
    for (auto& v : p.pixels) v = static_cast<std::uint8_t>(128.5 + 6 * random.normal());
    const double angle = random.uniform(0, 6.28);
    EdgeProfile profile;
    sample_profile(p.view(),
                   {static_cast<float>(random.uniform(30, 33)), static_cast<float>(random.uniform(30, 33))},
                   {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))}, 16, profile);
    measured += double(profile.noise);
    ++profiles;
    for (int i = 0; i < profile.count; ++i, ++steps)
      derivative += double(profile.derivative[i]) * profile.derivative[i];
  }
  const double white = 36 * 16 * 16, sampled = double(kSampledNoise) * white;
  CHECK(measured / profiles == doctest::Approx(sampled).epsilon(0.3));
  CHECK(derivative / steps == doctest::Approx(double(kWhiteNoiseGain.derivative) * sampled).epsilon(0.3));
}

}  // namespace edge_profile_test
