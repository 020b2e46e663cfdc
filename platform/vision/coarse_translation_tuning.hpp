#pragma once
// Tuned constants of the coarse translation.

namespace pliant {

/// Tuning of the coarse search. Each constant: unit, reason, experiment.
struct CoarseTranslationTuning {
  /// Pixels compared for each shift, at most about: of larger boxes rows are left out. Bounds the cost; with
  /// the default limits a face that fills half of the frame has every second row. Round value, not tuned.
  int max_pixels = 1200;
  /// Smallest side of a box, px. Guard, not tuned.
  int min_side_px = 4;
  /// A shift is considered if at least one pixel in this many is in both images. Round value, not tuned.
  int min_overlap_divisor = 2;
  /// Step of the first search, px. Correlation peaks of a thumbnail are wider than this; the shifts between are
  /// tried around the best only. With 3 every film with faults of the recorded face is as with 2, and a search
  /// of the whole picture takes 3.6 instead of 7.7 million instructions.
  int first_step_px = 3;
  /// Correlation by which the peak near the expected shift may be below the best. Of 24 films of patterns that repeat 17 are right
  /// in all frames with 0.1 and with 0.2, 14 with 0.05 (docs/experiments.md, Patterns that repeat).
  float most_below_best = 0.1f;
  /// Steps of a pixel, at most, by which the expected shift climbs to its peak; the last one finds nothing higher. Round value, not
  /// tuned.
  int most_climbs = 3;
};
inline constexpr CoarseTranslationTuning kCoarseTranslationTuning{};

/// Number of shifts that a search within `range_px` compares, at most: the coarse steps, those around the
/// best, none, and the best one's neighbours, for its fraction of a pixel.
constexpr int most_shifts(int range_px) {
  const int step = kCoarseTranslationTuning.first_step_px, coarse = 2 * (range_px / step) + 1,
            fine = 2 * step - 1;
  return coarse * coarse + fine * fine + 1 + 4;
}

/// The same of a search with an expected shift, beside those: that one, those around it and around each step from it, and the
/// neighbours of its peak.
inline constexpr int kMostExpectedShifts = 1 + 9 * kCoarseTranslationTuning.most_climbs + 4;

}  // namespace pliant
