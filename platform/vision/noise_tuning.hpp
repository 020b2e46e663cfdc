#pragma once

namespace pliant {

/// Tuning of the noise filter. Each constant: unit, reason, experiment.
struct NoiseTuning {
  /// Places that are compared, at most, count: the median of so many is known to 2 %. And at least: else nothing is known. Round
  /// values.
  int most_places = 4096, least_places = 256;
  /// Grey levels beyond which a place is clipped, and its noise with it: as PatchTuning.
  int darkest = 6, brightest = 249;
  /// Noise from which on frames are smoothed, and from which on smoothed ones are again, grey levels. Portraits at a quarter of
  /// their light are tracked in all frames with noise of 5, in 69 % with 7, in 2 % with 12; smoothed, in all. Of 762 photographs without noise
  /// 5 % are above 4.7, by their texture. Smoothing does not make bright portraits worse by more than 0.1 % of the eyes' distance
  /// (docs/experiments.md, Films of portraits with faults). Around one threshold frames would be smoothed in turns: the recorded face with noise of 4.9 to
  /// 5.1 then trembles by 0.185 instead of 0.115 px.
  float noisy = 5, still_noisy = 4;
};
inline constexpr NoiseTuning kNoiseTuning{};

}  // namespace pliant
