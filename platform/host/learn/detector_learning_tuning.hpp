#pragma once
/// \file detector_learning_tuning.hpp
/// Constants of the detector's training that were chosen.
#include <cstddef>

#include "host/learn/boosted_trees.hpp"

namespace pliant::host::learn {

/// Tuning of the detector's training. Each constant: unit, reason, experiment.
struct DetectorLearningTuning {
  /// Samples of faces, count. The sizes of the training grew together (docs/experiments.md, Samples).
  std::size_t samples = 24000;
  /// Windows that each sample gives, count, shifted and zoomed at random. Round value, not tuned.
  std::size_t windows_a_sample = 2;
  /// Largest shift of a window, as a fraction of its side: half a cell is 1/24, and a little more is taken.
  float shift = 0.05f;
  /// Largest change of a window's size: half the step between the sizes that are searched is 2^(1/8), 1.09.
  float zoom = 1.1f;
  /// Windows of pictures without faces, at random places, before the first round, count. Round value.
  std::size_t random_others = 20000;
  /// Hits that are added before each later round, and windows of others in all, count (see samples).
  std::size_t hits_a_round = 20000, most_others = 80000;
  /// Hits that one picture may add in a round, count: no single picture fills a round. Round value, not tuned.
  std::size_t hits_a_picture = 40;
  /// Samples of faces that are searched beside the face in a round, count (see samples).
  std::size_t searched_samples = 6000;
  /// Of the hits of a round: those beside faces, as a fraction at most. A chin taken for a face, or a head, hides the face.
  double beside_hits = 0.5;
  /// Overlap with the face box below which a hit is false: between this and a good hit it is neither.
  float beside_overlap = 0.4f;
  /// Trees of each round, count.
  std::size_t trees[5] = {32, 64, 128, 320, 1024};
  /// Faces that the thresholds may lose, as a fraction, while hits are collected: some samples are too dark to see.
  double lost_faces = 0.02;
  /// Frames without faces that may have a false hit in the end, as a fraction: alignment tells them from faces, and costs as much
  /// as half a search.
  double false_hits = 0.15;
  BoostTuning boosting;
};
inline constexpr DetectorLearningTuning kDetectorLearningTuning{};

}  // namespace pliant::host::learn
