#pragma once
/// \file detector_calibration.hpp
/// The probability that a hit of the detector is a face.
#include <cstdint>
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

/// Calibrates for frames of 320 x 240 px of which half have one face: what is best in a frame is a face with this probability.
/// \param faces   the highest sum for each of many faces that did not train the trees.
/// \param others  pictures for which `calibrates` is true are searched.
Calibration calibrate(const std::vector<DetectorTree>& trees, const std::vector<int>& faces,
                      const OtherPictures& others, const LearnOptions& options);

/// Whether picture `k` of `count` is kept for calibration and does not train the trees.
constexpr bool calibrates(std::size_t k, std::size_t count) {
  return count >= 10 && k % 10 == 9;
}

/// Writes the broken line of the probability above the last rejection threshold.
void set_knots(const Calibration& calibration, int least_sum, DetectorHeader* header);

}  // namespace pliant::host::learn
