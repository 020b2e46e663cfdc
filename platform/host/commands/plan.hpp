#pragma once
/// \file plan.hpp
/// Memory and work of a tracker with given limits: bytes by purpose, and how often each loop of a frame runs.
#include <vector>

#include "pliant/tracker.hpp"

namespace pliant::host {

/// One kind of work in a frame.
struct Load {
  const char* what;
  double usual;       ///< count in a usual frame
  double most;        ///< count in any frame, at most
  double operations;  ///< multiply-adds each, estimated
};

/// Bounds of the frames without a track, where the model has learnt tables and the limits name detection; else 0.
struct SearchPlan {
  std::uint32_t cells = 0;      ///< of one frame's search, at most: the limit, and the rest of a row
  std::uint32_t all_cells = 0;  ///< of the search of the whole frame
  int search_frames = 0;        ///< that it takes, at most
  int steps = 0;                ///< of one frame's alignments, at most
  int alignment_steps = 0;      ///< of an alignment
  int alignment_frames = 0;     ///< that one takes; the last of them starts the track
  bool does_both = false;       ///< a frame has a part of the search and alignments; else one of them
};

struct Plan {
  std::size_t bytes[kPurposeCount] = {};  ///< by Purpose
  std::size_t arena_bytes = 0;            ///< their sum: what create_in takes
  std::size_t free_parameters = 0;
  int most_iterations = 0;  ///< Gauss-Newton steps of a frame, at most; as FrameResult counts them
  std::vector<Load> loads;
  SearchPlan search;

  double usual_operations() const;
  double most_operations() const;
};

/// The plan for the default options with free expressions.
Plan make_plan(const Model& model, const TrackerLimits& limits);

}  // namespace pliant::host
