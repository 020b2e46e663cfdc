#pragma once
/// \file plan.hpp
/// What a tracker with given limits takes: bytes by purpose, and how often each loop of a frame runs.
#include <vector>

#include "pliant/tracker.hpp"

namespace pliant::host {

/// One kind of work in a frame.
struct Load {
  const char* what;
  double usual;       ///< times a frame, while tracking
  double most;        ///< no frame does it more often
  double operations;  ///< multiply-adds each time, estimated
};

struct Plan {
  std::size_t bytes[kPurposeCount] = {};  ///< by Purpose
  std::size_t arena_bytes = 0;            ///< their sum: what create_in takes
  std::size_t free_parameters = 0;
  int most_iterations = 0;  ///< Gauss-Newton steps of a frame, at most; as FrameResult counts them
  std::vector<Load> loads;

  double usual_operations() const;
  double most_operations() const;
};

/// With the default options; the expressions are free.
Plan make_plan(const Model& model, const TrackerLimits& limits);

}  // namespace pliant::host
