#pragma once
/// \file occlusion.hpp
/// The occlusion experiment: observations of a face's points, some of them false, and what the estimator makes of one frame
/// with each way to deal with outliers (docs/algorithms.md, section 6.5).
#include "pliant/estimator.hpp"

namespace pliant::host {

enum class Disturbance {
  none,
  random,      ///< single points, up to 12 px off
  moving,      ///< a patch of neighbours that moves as another rigid thing
  standing,    ///< one that stays where it was
  expression,  ///< nothing false: the jaw drops by a third of its range between two frames
};

/// Ways to deal with it. The first three start from the old state, the last two from a prediction that knows four fifths
/// of the motion.
enum class Defence { least_squares, weights, forces, weights_predicted, forces_predicted, on_doubt };
constexpr int kDefences = 6;
const char* name_of(Defence defence);

/// Error of the estimated state over all points, false ones too.
struct OcclusionResult {
  double mean_px[kDefences] = {}, share_over_3px[kDefences] = {}, us[kDefences] = {};
};

/// 320 x 240, 120 visible points, noise of 0.4 px; random poses, shapes and motions (0.03 rad, 1.5 %, 4 mm).
/// \param share  of the points, that is false.
OcclusionResult measure_occlusion(const Model& model, Disturbance disturbance, double share, int scenes,
                                  int trials_a_scene);

}  // namespace pliant::host
