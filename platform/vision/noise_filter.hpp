#pragma once
/// \file noise_filter.hpp
/// Measures the noise of each frame, and smooths those with much of it (docs/algorithms.md, section 7.22).
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/frame.hpp"

namespace pliant {

/// Standard deviations, grey levels: of the noise, up to 63, and of the frame with it.
struct FrameNoise {
  float noise = 0, contrast = 0;
};

/// Distance of the places where noise is measured, px: of a square grid of at most NoiseTuning::most_places. Odd, so that they have
/// all places in the blocks of compressed frames.
int noise_step(int width, int height);
/// How many there are along a side. Those at the border have no neighbours.
int noise_places(int side, int step);

/// Measured at NoiseTuning::most_places places at most; clipped ones do not count. Both 0 for a view with fewer than
/// NoiseTuning::least_places. Fine texture all over a frame counts as noise.
FrameNoise noise_of(const FrameView& frame);

/// Smooths noisy frames of one size, at least 4 x 4 pixels.
class NoiseFilter {
 public:
  /// Bytes: width * height, and five lines of 2 bytes a pixel.
  void lay_out(Arena& arena, int width, int height);

  /// The frame itself, if it has little noise. Else a copy, smoothed by the binomial [1 4 6 4 1]/16 along rows and columns, valid
  /// until the next call. Cost: the places, and 14 additions a pixel of a noisy frame.
  const FrameView& smoothed(const FrameView& frame);
  /// The next frame is of another stream.
  void forget() { is_smoothing_ = false; }

 private:
  void smooth(const FrameView& frame);

  std::uint8_t* pixels_ = nullptr;
  std::uint16_t* lines_ = nullptr;
  FrameView copy_;
  bool is_smoothing_ = false;  // the last frame was noisy
};

}  // namespace pliant
