#pragma once
/// \file search_plan.hpp
/// How a search is divided into frames.
#include <cstddef>
#include <cstdint>

#include "face/aligner_table.hpp"
#include "pliant/tracker_limits.hpp"

namespace pliant::host {

/// Bounds of the frames without a track, where the model has learnt tables and the limits name detection; else 0.
struct SearchPlan {
  std::uint32_t cells = 0;       ///< of one frame's search, at most: the limit, and the rest of a row
  std::uint64_t near_cells = 0;  ///< near the candidates of a search of several frames, at most in one frame
  double near_area = 0;          ///< as cell_area
  std::uint32_t all_cells = 0;   ///< of the search of the whole frame
  double cell_area = 0;          ///< of the cells of one frame, at most, in cells of its full size
  std::uint64_t turned_pixels = 0;  ///< drawn in one frame, at most; 0: only upright frames are searched
  int search_frames = 0;            ///< that it takes, at most
  int steps = 0;                    ///< of one frame's alignments, at most
  int alignment_steps = 0;          ///< of an alignment
  int alignment_frames = 0;         ///< that one takes; the last of them starts the track
  bool does_both = false;           ///< a frame has a part of the search and alignments; else one of them
};

/// Of a search for a face.
SearchPlan search_plan(const AlignerTable& table, const TrackerLimits& limits);

/// Bounds of a search for a print: of one that finds as many corners and matches as there is room for. With fewer, or cheaper ones,
/// no frame ends before the same part.
struct PrintSearchPlan {
  int frames = 1;         ///< that it takes, at most
  std::size_t cells = 0;  ///< of one frame, at most: a part that is begun is done
  std::size_t fits = 0;   ///< of one frame, at most
};
/// \param records  of the model's cascade.
PrintSearchPlan print_search_plan(const TrackerLimits& limits, std::size_t keypoints, std::size_t records);

}  // namespace pliant::host
