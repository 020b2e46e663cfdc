#pragma once
// Tuned constants of the noise filter.
#include "vision/patch_tuning.hpp"

namespace pliant {

/// Tuning of the noise filter. Each constant: unit, reason, experiment.
struct NoiseTuning {
  /// Places of a frame that are compared, at most, count: the median of so many is known to 2 %. Round value.
  int most_places = 4096;
  /// Fraction of them with which noise is measured, at least: else nothing is known. Round value, not tuned.
  int least_divisor = 16;
  /// Grey levels beyond which a place is clipped, and its noise with it: those within which PatchTuning uses a pixel.
  int darkest = patch::kPatchTuning.lowest_grey + 1, brightest = patch::kPatchTuning.highest_grey - 1;
  /// Noise over the frame's contrast from which on frames are smoothed, and from which on smoothed ones are again. Around one
  /// threshold they would be smoothed in turns: the recorded face, at threshold, then trembles by 0.185 instead of 0.115 px. How
  /// they were chosen: docs/experiments.md, Films of portraits with faults.
  float noisy = 0.42f, still_noisy = 0.35f;
  /// Least such noise, grey levels: below, it is of the steps of grey. Round value, not tuned.
  float least_noise = 2;
};
inline constexpr NoiseTuning kNoiseTuning{};

}  // namespace pliant
