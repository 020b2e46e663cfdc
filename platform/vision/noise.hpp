#pragma once
/// \file noise.hpp
/// Measures the noise of a frame or picture (docs/algorithms.md, section 7.22).
#include "pliant/frame.hpp"
#include "vision/noise_tuning.hpp"

namespace pliant {

/// Standard deviations, grey levels: of the noise, up to 63, and of the frame with it.
struct FrameNoise {
  float noise = 0, contrast = 0;
};

/// Distance of the places where noise is measured, px: of a square grid of at most so many. Odd, so that they have all places in
/// the blocks of compressed frames.
int noise_step(int width, int height, int most_places = kNoiseTuning.most_places);
/// How many there are along a side. Those at the border have no neighbours.
int noise_places(int side, int step);

/// Measured at so many places at most; clipped ones do not count. Both 0 for a view with fewer than a 16th of them. Fine texture
/// all over a frame counts as noise.
FrameNoise noise_of(const FrameView& frame, int most_places = kNoiseTuning.most_places);

}  // namespace pliant
