#pragma once
// Smoothing of noisy frames in a tracker of faces.
#include "pliant/tracker_limits.hpp"
#include "vision/noise_filter.hpp"

namespace pliant {

/// Whether the frames of this model are smoothed: faces. The print of a sheet is as fine as noise.
bool is_smoothed(const Model& model);

/// Makes a noise filter, and calls it (`kNoiseSmoothing`, tracker_limits.hpp).
struct NoiseSmoothing {
  NoiseFilter* (*lay_out)(Arena& arena, const Model& model,
                          const TrackerLimits& limits);  ///< null: not of this model
  const FrameView& (*smoothed)(NoiseFilter& filter, const FrameView& frame);
};

}  // namespace pliant
