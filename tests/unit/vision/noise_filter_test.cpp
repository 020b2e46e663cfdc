#include "vision/noise_filter.hpp"

#include <doctest/doctest.h>

#include "model_builder.hpp"
#include "noisy_frame.hpp"
#include "vision/noise.hpp"

namespace noise_filter_test {

using namespace pliant;

namespace {

constexpr int kWidth = 160, kHeight = 120;

int tap(int k) {
  constexpr int kBinomial[] = {1, 4, 6, 4, 1};
  return kBinomial[k + 2];
}

}  // namespace

TEST_CASE("a quiet frame passes as it is; a noisy one is smoothed until the noise has clearly fallen") {
  InArena<NoiseFilter> filter(kWidth, kHeight);
  const auto is_copied = [&](float sd) {
    const NoisyFrame frame(sd);
    const FrameView view = frame.view(), out = filter->smoothed(view);
    CHECK((out.width == kWidth && out.height == kHeight && out.time_ns == 5 && out.sequence == 3));
    return out.data != view.data;
  };
  CHECK_FALSE(is_copied(8));
  CHECK_FALSE(is_copied(11));
  CHECK(is_copied(14));
  CHECK(is_copied(11));
  CHECK_FALSE(is_copied(8));
  CHECK_FALSE(is_copied(11));
}

TEST_CASE("how much noise is much depends on the contrast: the same in a quarter of the light is") {
  const auto is_smoothed = [](float light) {
    NoisyFrame frame(0);
    Random random(3);
    for (std::uint8_t& p : frame.pixels)
      p = static_cast<std::uint8_t>(clamp(20 + light * static_cast<float>(p) + 5 * random.normal(), 0, 255));
    InArena<NoiseFilter> filter(kWidth, kHeight);
    return filter->smoothed(frame.view()).data != frame.view().data;
  };
  CHECK_FALSE(is_smoothed(1));
  CHECK(is_smoothed(0.25f));
}

TEST_CASE("a flat frame with the noise of its grey steps is not smoothed") {
  NoisyFrame frame(0);
  Random random(3);
  for (std::uint8_t& p : frame.pixels) p = static_cast<std::uint8_t>(100 + random.below(2));
  InArena<NoiseFilter> filter(kWidth, kHeight);
  const FrameView view = frame.view();
  CHECK(filter->smoothed(view).data == view.data);
}

TEST_CASE("a smoothed frame is the binomial mean of 5 x 5 pixels, the border continued") {
  for (const int step : {1, 2}) {
    CAPTURE(step);
    NoisyFrame frame(15, kWidth, kHeight, step);
    const FrameView view = frame.view();
    InArena<NoiseFilter> filter(kWidth, kHeight);
    const FrameView out = filter->smoothed(view);
    REQUIRE(out.data != view.data);
    REQUIRE(out.pixel_step_bytes == 1);
    int wrong = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        int sum = 128;
        for (int j = -2; j <= 2; ++j)
          for (int i = -2; i <= 2; ++i) {
            const int u = x + i < 0 ? 0 : x + i < kWidth ? x + i : kWidth - 1;
            const int v = y + j < 0 ? 0 : y + j < kHeight ? y + j : kHeight - 1;
            sum += tap(i) * tap(j) * frame.at(u, v);
          }
        wrong += out.data[static_cast<std::size_t>(y) * out.stride_bytes + static_cast<std::size_t>(x)] !=
                 static_cast<std::uint8_t>(sum >> 8);
      }
    CHECK(wrong == 0);
    CHECK(noise_of(out).noise < 3);
  }
}

TEST_CASE("a filter takes a copy of the frame and five lines of sums") {
  CHECK(measured_bytes<NoiseFilter>(320, 240) == 320 * 240 + 5 * 320 * 2);
}

}  // namespace noise_filter_test
