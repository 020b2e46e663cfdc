#pragma once
/// \file boosted_trees.hpp
/// Boosting of the detector's trees over bytes (LogitBoost; Friedman, Hastie and Tibshirani 2000).
#include <cstdint>
#include <functional>
#include <vector>

#include "host/learn/detector_windows.hpp"

namespace pliant::host::learn {

/// Tuning of boosting. Each constant: unit, reason, experiment.
struct BoostTuning {
  /// Fraction of the features that are tried for a node: fewer are faster and overfit less (Dollar et al. 2014 take 1/16).
  float feature_fraction = 0.125f;
  /// Of a tree's leaf values. Round value.
  float shrinkage = 1.0f;
  /// Added to the curvature of a leaf, as a fraction of all samples: bounds the leaf's value.
  double smoothing = 2e-4;
};

/// The value of a leaf in units of half the logarithm of odds: 1/kLeafUnit.
constexpr int kLeafUnit = 32;

/// Trees that tell `faces` from `others`, without rejection thresholds. The same for the same seed, whatever the threads.
/// \param done  called with the number of trees so far; may be empty.
std::vector<DetectorTree> boost_trees(const std::vector<Window>& faces, const std::vector<Window>& others,
                                      std::size_t tree_count, const BoostTuning& tuning, std::uint64_t seed,
                                      int threads, const std::function<void(std::size_t)>& done);

}  // namespace pliant::host::learn
