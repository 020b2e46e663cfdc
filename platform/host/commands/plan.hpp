#pragma once
/// \file plan.hpp
/// Memory and work of a tracker with given limits: bytes by purpose, and how often each loop of a frame runs.
#include <vector>

#include "host/commands/search_plan.hpp"
#include "pliant/tracker.hpp"

namespace pliant::host {

/// How the bound of a load goes into that of a frame.
enum class Bound {
  always,  ///< every frame may have it
  beside,  ///< the same; Tracker::work counts it with what shares the budget
  shared,  ///< it is a part of the frame's budget: those that are shared have `most` of one of them together
};

/// One kind of work in a frame.
struct Load {
  const char* what;
  double usual;         ///< count in a usual frame
  double most;          ///< count in any frame, at most
  double instructions;  ///< of x86-64 each, measured
  Bound bound = Bound::always;
};

struct Plan {
  std::size_t bytes[kPurposeCount] = {};  ///< by Purpose
  std::size_t arena_bytes = 0;            ///< their sum: what create_in takes
  std::size_t free_parameters = 0;
  int most_iterations = 0;            ///< Gauss-Newton steps of a frame, at most; as FrameResult counts them
  std::vector<Load> loads;            ///< of a frame with a track
  std::vector<Load> alignment_loads;  ///< of a frame with a track whose templates fail, besides
  std::vector<Load> edge_loads;       ///< of the first frame after a start, besides
  /// Of the first two of the frames that share the start of a track which begins while another one ends, besides.
  std::vector<Load> anew_loads[2];
  std::vector<Load> search_loads;  ///< of a frame that searches for a face or a print
  std::vector<Load>
      start_loads;  ///< of a frame in which a track starts; with what it has searched before, where it does both
  SearchPlan search;
  int print_search_frames =
      0;  ///< frames of a search for the model's print, at most; 0: none is searched for
};

/// Sums, instructions of x86-64.
double usual_instructions(const std::vector<Load>& loads);
double most_instructions(const std::vector<Load>& loads);
/// The same of what Tracker::work counts.
double most_counted_instructions(const std::vector<Load>& loads);
/// Instructions of a Cortex-M7 for one of x86-64, an estimate: 1.81 in the tracked frames of the firmware example, 1.70 with
/// detection, 1.16 in its frames of a search (docs/evaluation.md, Work of a frame). It has no vectors.
constexpr double kCortexM7Factor = 1.8;

/// The plan for the default options with free expressions.
Plan make_plan(const Model& model, const TrackerLimits& limits);

}  // namespace pliant::host
