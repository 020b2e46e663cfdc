#pragma once
/// \file part_learning.hpp
/// Learns to read the points of one part of a face, stage by stage.
#include <cstdint>
#include <vector>

#include "face/part_table.hpp"
#include "host/learn/face_samples.hpp"
#include "host/learn/learn_options.hpp"

namespace pliant::host::learn {

/// Errors of the pose at which a crop is cut, and how the regression is set up. Each constant: unit, reason, experiment.
struct PartLearningTuning {
  /// People are divided into this many folds. An example moves by weights that were learnt without its fold.
  int folds = 4;
  /// Errors of a tracker's pose: standard deviations of turn, rad, logarithm of scale, and place, mm. Not tuned.
  float turn_rad = 0.03f, log_scale = 0.03f, shift_mm = 1.0f;
  /// Weight of a point by its trust: hidden, fitted, annotated.
  double weight_of_trust[3] = {0, 0.3, 1};
  /// Strength of the ridge, a fraction of the mean variance of an input. Of 0.4 and 1.6, 1.6 reads people left out better.
  double ridge = 1.6;
  /// Least variance of a reading, mm^2. Not tuned.
  double least_variance = 0.02;
};

/// Weights of a stage, L points, D bytes of all blocks; mm.
struct LearntPartStage {
  std::vector<double> rows;  ///< 2 L x D
  std::vector<double> bias;  ///< 2 L
};

/// A part with its weights.
struct LearntPart {
  PartRecord record{};
  std::vector<double> start;        ///< 2 L
  std::vector<double> information;  ///< 3 L
  std::vector<LearntPartStage> stages;
};

/// Learns one part from `samples` pictures of faces.
LearntPart learn_part(const Model& model, const FaceSamples& faces, const PartRecord& record,
                      const LearnOptions& options, std::size_t samples, const LearnProgress& progress,
                      const PartLearningTuning& tuning = {});

/// The table of these parts.
std::vector<std::uint8_t> encode_parts(const std::vector<LearntPart>& parts);

}  // namespace pliant::host::learn
