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
};
inline constexpr CoarseTranslationTuning kCoarseTranslationTuning{};

/// Number of shifts that a search within `range_px` compares, at most: the coarse steps, those around the
/// best, none, and the best one's neighbours, for its fraction of a pixel.
constexpr int most_shifts(int range_px) {
  const int step = kCoarseTranslationTuning.first_step_px, coarse = 2 * (range_px / step) + 1,
            fine = 2 * step - 1;
  return coarse * coarse + fine * fine + 1 + 4;
}

}  // namespace pliant
