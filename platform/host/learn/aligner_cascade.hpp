#pragma once
/// \file aligner_cascade.hpp
/// Learns the stages of alignment, one after the other, each from the faces as the stages before it left them.
#include <cstdint>
#include <vector>

#include "host/learn/aligner_encoding.hpp"
#include "host/learn/aligner_examples.hpp"
#include "host/learn/learn_options.hpp"
#include "host/learn/ridge.hpp"

namespace pliant::host::learn {

/// Tuning of the learning of stages. Each constant: unit, reason, experiment.
struct AlignerCascadeTuning {
  /// People are divided into this many folds. An example moves by weights that were learnt without its fold, so that the
  /// next stage and the verification learn from errors as large as those on new people.
  int folds = 4;
  /// Weight of a landmark by its trust: hidden, fitted, annotated.
  double weight_of_trust[3] = {0, 0.3, 1};
  /// Strengths of the ridge that are tried on people left out; fractions of the mean variance of an input.
  std::vector<double> ridges = {0.1, 0.4, 1.6, 6};
  /// Least variance of a prediction, mm^2. Not tuned.
  double least_variance = 0.3;
  /// A displacement further than this is no example for a local stage, mm.
  double most_displacement_mm = 40;
};

/// Learns a cascade of the given stages.
class AlignerCascade {
 public:
  AlignerCascade(const Model& model, std::vector<int> numbers, const LearnOptions& options,
                 const AlignerCascadeTuning& tuning = {});

  std::vector<AlignerExample>& examples() { return examples_; }

  /// Learns one more stage and moves all examples by it.
  void learn(const AlignerStage& shape);
  /// Sets the blend of the last stage. After the last `learn`.
  void learn_blend();

  /// Table without a fold, or of all examples (fold = folds).
  std::vector<std::uint8_t> table(int fold, const LearntCheck* check = nullptr) const;
  const std::vector<LearntStage>& stages() const { return stages_.back(); }  ///< learnt from all examples
  int folds() const { return tuning_.folds; }
  const std::vector<int>& numbers() const { return numbers_; }
  const Model& model() const { return model_; }
  const LearnOptions& options() const { return options_; }
  /// The pass of a thread, for the landmarks of `numbers`.
  AlignerPass& pass(std::size_t thread) { return **passes_[thread]; }

 private:
  AlignerPass& start_pass(std::size_t thread, const AlignerExample& example) const;
  void learn_local(const AlignerStage& shape);
  void learn_global(const AlignerStage& shape);
  void collect_blocks(const AlignerStage& shape);
  void collect_grids(const AlignerStage& shape);
  void learn_global_information(std::size_t bytes, std::vector<LearntStage>* learnt) const;
  void sum_pair(const AlignerStage& shape, std::size_t k, std::size_t other, int fold, RidgeSums* sums) const;
  void learn_pair(const AlignerStage& shape, std::size_t k, std::size_t other,
                  std::vector<LearntStage>* learnt) const;
  void learn_information(const AlignerStage& shape, std::size_t k, std::size_t other,
                         std::vector<LearntStage>* learnt) const;
  double weight_of(std::size_t example, std::size_t k) const;
  double choose_ridge(const std::vector<RidgeSums>& folds) const;
  std::vector<double> information(const std::vector<double>& moments, double weight) const;
  void move_examples();

  const Model& model_;
  std::vector<int> numbers_;
  LearnOptions options_;
  AlignerCascadeTuning tuning_;
  std::vector<AlignerExample> examples_;
  std::vector<std::vector<LearntStage>> stages_;  // of each fold left out, then of all
  std::vector<std::unique_ptr<OwnedPass>> passes_;
  // Of the stage being learnt.
  std::vector<std::vector<std::uint8_t>> blocks_;  // local: a landmark; global: one
  std::vector<std::vector<double>> wanted_;        // displacements, two an example
  std::vector<float> gates_;                       // an example
};

}  // namespace pliant::host::learn
