#pragma once
/// \file occlusion_experiment.hpp
/// The occlusion experiment: the error of one frame with false observations, for each method of outlier rejection
/// (docs/algorithms.md, section 6.5).
#include "pliant/estimator.hpp"

namespace pliant::host {

/// Kinds of false observations.
enum class Disturbance {
  none,
  random,      ///< single points, up to 12 px off
  moving,      ///< neighbouring points that move with another rigid object
  standing,    ///< neighbouring points that stay at their old image positions
  expression,  ///< no false observation; the jaw opens by a third of its range between two frames
};

/// Methods of outlier rejection. The first three start from the old state, the last three from a prediction that contains
/// four fifths of the motion.
enum class RejectionMethod { least_squares, weights, forces, weights_predicted, forces_predicted, on_doubt };
constexpr int kMethods = 6;
const char* name_of(RejectionMethod method);

/// Mean error of the estimated state over all points, fraction of trials with more than 3 px, and time of a solve, for each
/// method.
struct OcclusionResult {
  double mean_px[kMethods] = {}, fraction_over_3px[kMethods] = {}, us[kMethods] = {};
};

/// Runs the experiment at 320 x 240 with 120 visible points, noise of 0.4 px, and random poses, shapes and motions (standard
/// deviations 0.03 rad, 1.5 %, 4 mm). \param fraction  fraction of the points with false observations, 0..1.
OcclusionResult measure_occlusion(const Model& model, Disturbance disturbance, double fraction, int scenes,
                                  int trials_a_scene);

}  // namespace pliant::host
