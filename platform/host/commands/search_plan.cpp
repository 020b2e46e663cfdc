#include "host/commands/search_plan.hpp"

#include <algorithm>

#include "face/detector_table.hpp"
#include "face/scaled_lines.hpp"
#include "face/search_place.hpp"
#include "face/turned_picture.hpp"
#include "print/print_matcher.hpp"
#include "print/print_tuning.hpp"
#include "track/detection_state.hpp"
#include "track/face_search.hpp"

namespace pliant::host {

namespace {

/// Of the cells of a row, in cells of the frame's full size.
double area_of_row(const SearchPlace& place) {
  const double ratio = static_cast<double>(place.ratio()) / ScaledLines::kUnit;
  return ratio * ratio * place.columns();
}

/// Makes cells and area those of a search near a box of this side, if they are more.
void add_near_search(const TrackerLimits& l, TurnedSize frame, float side, std::uint32_t* most_cells,
                     double* most_area) {
  std::uint32_t cells = 0;
  double area = 0;
  SearchPlace place;
  const FaceBox box{{0.5f * static_cast<float>(frame.width), 0.5f * static_cast<float>(frame.height)}, side};
  for (place.begin_near(frame.width, frame.height, l.smallest_face_px, box); !place.is_complete();
       place.advance()) {
    cells += static_cast<std::uint32_t>(place.columns());
    area += area_of_row(place);
  }
  *most_cells = std::max(*most_cells, cells);
  *most_area = std::max(*most_area, area);
}

/// The largest of a search of the whole frame.
struct SearchExtremes {
  std::uint32_t widest_row = 0, near_cells = 0;  // near: of a search near a candidate
  double row_area = 0, near_area = 0;
};

/// Divides a search of the whole frame into frames, and notes what the largest of them takes.
void divide_search(const TrackerLimits& limits, TurnedSize frame, std::uint32_t work, SearchExtremes* most,
                   SearchPlan* plan) {
  SearchPlace place;
  std::uint32_t done = work, all = 0;
  double area = 0;
  int frames = 0;
  for (place.begin(frame.width, frame.height, limits.smallest_face_px); !place.is_complete();
       place.advance()) {
    const auto columns = static_cast<std::uint32_t>(place.columns());
    if (done >= work) {  // a new frame
      ++frames;
      done = 0;
      area = 0;
    }
    done += columns;
    area += area_of_row(place);
    most->row_area = std::max(most->row_area, area_of_row(place));
    if (place.begins_strip())
      add_near_search(limits, frame, place.box(0, 0).side, &most->near_cells, &most->near_area);
    plan->cell_area = std::max(plan->cell_area, area);
    all += columns;
    most->widest_row = std::max(most->widest_row, columns);
  }
  plan->search_frames = std::max(plan->search_frames, frames);
  plan->all_cells = std::max(plan->all_cells, all);
  const std::uint64_t begun = std::uint64_t{work} - 1 + most->widest_row;
  plan->cells = static_cast<std::uint32_t>(std::min<std::uint64_t>(plan->all_cells, begun));
}

/// The frame as it is, and at all its turns where faces are searched at any roll.
SearchExtremes divide_searches(const TrackerLimits& limits, std::uint32_t work, SearchPlan* plan) {
  SearchExtremes most;
  const int width = limits.width, height = limits.height;
  divide_search(limits, turned_size(width, height, 0), work, &most, plan);
  if (limits.detection->modules != &kRolledFaces) return most;
  for (const int turn : {1, 2}) divide_search(limits, turned_size(width, height, turn), work, &most, plan);
  plan->turned_pixels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  return most;
}

/// Each alignment begins with a search near its candidate, unless a whole search has just found it; beside it the search goes on
/// after rows that it had already.
void add_near_cells(const SearchExtremes& most, SearchPlan* plan) {
  const int alignments = (plan->steps + plan->alignment_steps - 1) / plan->alignment_steps;
  const std::uint32_t rows_again = plan->does_both ? kWindowCells - 1 : 0;
  plan->near_cells = std::uint64_t{most.near_cells} * static_cast<std::uint64_t>(alignments) +
                     std::uint64_t{rows_again} * most.widest_row;
  plan->near_area = alignments * most.near_area + rows_again * most.row_area;
  plan->turned_pixels *= static_cast<std::uint64_t>(1 + alignments);
}

/// Frames of an alignment that begins in a frame of its own.
int alignment_frames(const SearchPlan& plan) {
  int frames = 0;
  for (int left = plan.alignment_steps; left > 0; ++frames) {
    const int taken = std::min(plan.steps, left);
    // Where the work is spread, the last step leaves its frame to the start of the track.
    left -= !plan.does_both && taken == left && taken > 1 ? taken - 1 : taken;
  }
  return frames;
}

}  // namespace

SearchPlan search_plan(const AlignerTable& table, const TrackerLimits& limits) {
  SearchPlan plan;
  const std::uint32_t work = std::max(limits.search_work, std::uint32_t{1});
  const SearchExtremes most = divide_searches(limits, work, &plan);
  plan.does_both = !is_spread(limits.search_work);
  plan.steps = steps_of(limits.search_work);
  // Where the work is spread, the score is taken twice.
  plan.alignment_steps = static_cast<int>(table.stage_count()) + (plan.does_both ? 1 : 2);
  if (!plan.does_both || plan.search_frames > 1) add_near_cells(most, &plan);
  plan.alignment_frames = alignment_frames(plan);
  return plan;
}

PrintSearchPlan print_search_plan(const TrackerLimits& limits, std::size_t keypoints, std::size_t records) {
  const PrintTuning& t = kPrintTuning;
  PrintSearchPlan plan;
  const std::size_t work = std::max(limits.search_work, std::uint32_t{1});
  std::size_t done = 0, all = 0;
  const auto add_parts = [&](std::size_t count, std::size_t cells) {
    for (std::size_t k = 0; k < count; ++k, done += cells)
      if (done >= work) ++plan.frames, done = 0;
  };
  const auto add_cells = [&](std::size_t count, std::size_t cells) {
    add_parts(count, cells);
    // With fewer corners this part may be the one with which a frame ends.
    plan.cells = std::max(plan.cells, std::min(work - 1, all + (count - 1) * cells) + cells);
    all += count * cells;
  };
  std::size_t corners = t.corners;  // those of the first level are described and compared twice
  for (int level = 0, width = limits.width, height = limits.height; level < t.levels; ++level) {
    const std::size_t of_level = t.corners >> level;
    add_cells(
        1, static_cast<std::size_t>(width * height) / t.pixels_per_cell + t.cells_per_descriptor * of_level);
    corners += of_level;
    width = (width + 1) / 2;
    height = (height + 1) / 2;
  }
  add_cells(corners, keypoints / t.keypoints_per_cell + 1);
  const std::size_t matches = PrintMatcher::most_matches();
  add_cells(matches, 1);
  add_cells(matches, matches / t.pairs_per_cell + 1);
  const std::size_t fit_cells = t.cells_of_fit(records), solutions = t.most_views * t.solutions,
                    of_solution = t.fits_of_solution(),
                    settling = static_cast<std::size_t>(t.settling_passes);
  add_parts(solutions, of_solution * fit_cells);
  add_parts(settling, fit_cells);
  plan.fits = std::min(work / fit_cells + of_solution, solutions * of_solution + settling);
  if (plan.frames > 1) ++plan.frames;  // in which the surface is carried to the present frame
  return plan;
}

}  // namespace pliant::host
