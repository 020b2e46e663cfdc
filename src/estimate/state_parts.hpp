#pragma once
// The parts of an estimator that hold the state and the points.
#include "estimate/model_state.hpp"
#include "estimate/motion_model.hpp"
#include "estimate/surface_points.hpp"
#include "pliant/estimator.hpp"

namespace pliant {

struct StateParts {
  ModelState state;    // as it is now
  ModelState trusted;  // of the last good frame
  MotionModel motion;
  SurfacePoints points;

  void lay_out(Arena& arena, std::size_t parameters, const EstimatorLimits& limits, std::size_t samples);
  /// Gives both states the parameters that are not free, turns them (q * turn), and samples the points anew.
  void revise(Cascade& cascade, const float* q, Quat turn);
};

}  // namespace pliant
