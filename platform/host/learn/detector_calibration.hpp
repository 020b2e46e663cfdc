#pragma once
/// \file detector_calibration.hpp
/// The probability that a hit of the detector is a face.
#include <vector>

#include "face/detector_table.hpp"
#include "host/learn/learn_options.hpp"
#include "host/learn/other_pictures.hpp"

namespace pliant::host::learn {

/// Probability 1 / (1 + exp(-(slope * sum + offset))).
struct Calibration {
  double slope = 0, offset = 0;
  double probability(double sum) const;
};

/// A sum of trees with its weight.
struct WeightedSum {
  double sum, weight;
};

/// Logistic regression. The slope is positive.
Calibration fit_calibration(const std::vector<WeightedSum>& faces, const std::vector<WeightedSum>& others);

/// The highest sum in each of many frames of 320 x 240 px, random parts of the pictures for which `calibrates` is true; kRejected
/// without a hit.
std::vector<int> best_sums_without_faces(const std::vector<DetectorTree>& trees, const OtherPictures& others,
                                         const LearnOptions& options);

/// Calibrates for frames of which half have one face: what is best in a frame is a face with this probability.
/// \param faces   the highest sum for each of many faces that did not train the trees.
/// \param others  the highest sum for each of many frames without faces.
/// \param least   sums below this are rejected.
Calibration calibrate(const std::vector<int>& faces, const std::vector<int>& others, int least);

/// With fewer pictures than this, all of them train and calibrate.
constexpr std::size_t kFewPictures = 10;
/// Whether picture `k` of `count` is kept for calibration and does not train the trees.
constexpr bool calibrates(std::size_t k, std::size_t count) {
  return count >= kFewPictures && k % 10 == 9;
}

/// Writes the broken line of the probability above the last rejection threshold.
void set_knots(const Calibration& calibration, int least_sum, DetectorHeader* header);

}  // namespace pliant::host::learn
