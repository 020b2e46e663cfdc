#include "vision/noise_filter.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "model_builder.hpp"
#include "random.hpp"
#include "vision/noise_tuning.hpp"

namespace noise_filter_test {

using namespace pliant;

namespace {

constexpr int kWidth = 160, kHeight = 120;

/// A grey ramp with two edges, and noise over it. Rows have a few bytes behind them.
struct Frame {
  std::vector<std::uint8_t> pixels;
  explicit Frame(float sd, int width = kWidth, int height = kHeight, int step = 1, float base = 90)
      : width_(width), height_(height), step_(step), stride_(width * step + 3) {
    Random random(7);
    pixels.resize(static_cast<std::size_t>(height * stride_), 200);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const float clean = base + 0.25f * static_cast<float>(x) + (x > width / 2 ? 30.0f : 0.0f) +
                            (y > height / 3 ? 20.0f : 0.0f);
        at(x, y) = static_cast<std::uint8_t>(clamp(clean + sd * random.normal() + 0.5f, 0, 255));
      }
  }
  std::uint8_t& at(int x, int y) { return pixels[static_cast<std::size_t>(y * stride_ + x * step_)]; }
  FrameView view() const {
    return {pixels.data(), width_, height_, static_cast<std::size_t>(stride_), step_, 5, 3};
  }

 private:
  int width_, height_, step_, stride_;
};

int tap(int k) {
  constexpr int kBinomial[] = {1, 4, 6, 4, 1};
  return kBinomial[k + 2];
}

}  // namespace

TEST_CASE("noise is measured to a tenth, or half a grey level, whatever ramps and edges are below") {
  for (const float sd : {0.0f, 2.0f, 4.0f, 7.0f, 12.0f, 25.0f}) {
    CAPTURE(sd);
    const float noise = noise_of(Frame(sd).view()).noise;
    CHECK(noise > 0.9f * sd - 0.5f);
    CHECK(noise < 1.1f * sd + 0.5f);
  }
  CHECK(noise_of(Frame(7, 640, 480).view()).noise == doctest::Approx(7).epsilon(0.1));
  CHECK(noise_of(Frame(7, kWidth, kHeight, 2).view()).noise == doctest::Approx(7).epsilon(0.1));
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
    Frame between(0, 640, 480), clean(0, 640, 480);
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

TEST_CASE("places that are clipped, black or white, do not count") {
  for (const int clipped : {0, 255}) {
    CAPTURE(clipped);
    Frame frame(8);
    for (int y = 0; y < kHeight * 6 / 10; ++y)
      for (int x = 0; x < kWidth; ++x) frame.at(x, y) = static_cast<std::uint8_t>(clipped);
    CHECK(noise_of(frame.view()).noise == doctest::Approx(8).epsilon(0.1));
    CHECK(noise_of(frame.view()).contrast < 30);
  }
}

TEST_CASE("where nothing can be measured there is no noise") {
  CHECK(noise_of(Frame(7, 1, 1).view()).noise == 0);
  CHECK(noise_of(Frame(7, 10, 10).view()).noise == 0);
  CHECK(noise_of(Frame(7, 17, 18).view()).noise == 0);
  CHECK(noise_of(Frame(7, 18, 18).view()).noise > 4);                    // 256 places
  CHECK(noise_of(Frame(9, kWidth, kHeight, 1, 400).view()).noise == 0);  // white
}

TEST_CASE("a quiet frame passes as it is; a noisy one is smoothed until the noise has clearly fallen") {
  InArena<NoiseFilter> filter(kWidth, kHeight);
  const auto is_copied = [&](float sd) {
    const Frame frame(sd);
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
    Frame frame(0);
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
  Frame frame(0);
  Random random(3);
  for (std::uint8_t& p : frame.pixels) p = static_cast<std::uint8_t>(100 + random.below(2));
  InArena<NoiseFilter> filter(kWidth, kHeight);
  const FrameView view = frame.view();
  CHECK(filter->smoothed(view).data == view.data);
}

TEST_CASE("a smoothed frame is the binomial mean of 5 x 5 pixels, the border continued") {
  for (const int step : {1, 2}) {
    CAPTURE(step);
    Frame frame(15, kWidth, kHeight, step);
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
