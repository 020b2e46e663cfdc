#pragma once
// A frame with a known standard deviation of its noise.
#include <cstdint>
#include <vector>

#include "pliant/frame.hpp"
#include "pliant/geometry.hpp"
#include "random.hpp"

namespace pliant {

/// A grey ramp with two edges, and noise over it. Rows have a few bytes behind them.
struct NoisyFrame {
  std::vector<std::uint8_t> pixels;
  explicit NoisyFrame(float sd, int width = 160, int height = 120, int step = 1, float base = 90)
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

}  // namespace pliant
