#pragma once
/// \file noise.hpp
/// Measures the noise of a frame or picture (docs/algorithms.md, section 7.22).
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

}  // namespace pliant
