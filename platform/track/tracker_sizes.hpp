#pragma once
// What follows from a tracker's limits.
#include <cstddef>

#include "base/integers.hpp"
#include "estimate/stretch_rows.hpp"
#include "estimate/track_monitor.hpp"
#include "pliant/frame_work.hpp"
#include "pliant/tracker_limits.hpp"
#include "track/template_tuning.hpp"

namespace pliant {

/// Side of a corner cell, px: 8 at 320 x 240, less where more patches are wanted than a face has such cells.
constexpr int cell_px_of(const TrackerLimits& limits) {
  const TemplatePlacementTuning& t = kTemplatePlacementTuning;
  int side = (limits.width + t.cells_across / 2) / t.cells_across;
  if (side > t.most_cell_px) side = t.most_cell_px;
  while (side > t.least_cell_px &&
         t.least_cells_a_template * side * side * limits.patches > limits.width * limits.height)
    --side;
  return side < t.least_cell_px ? t.least_cell_px : side;
}

constexpr int region_width(const TrackerLimits& limits) {
  return limits.region_width > 0 && limits.region_width < limits.width ? limits.region_width : limits.width;
}
constexpr int region_height(const TrackerLimits& limits) {
  return limits.region_height > 0 && limits.region_height < limits.height ? limits.region_height
                                                                          : limits.height;
}

/// Pixels at an image width of kNominalWidthPx, in those of a frame of another width.
constexpr float scaled_px(int frame_width, float px) {
  return px * static_cast<float>(frame_width) / kNominalWidthPx;
}
/// Pixels at an image width of kNominalWidthPx, in the frame's own.
constexpr float scaled_px(const TrackerLimits& limits, float px) {
  return scaled_px(limits.width, px);
}

/// Templates that a start captures at once, if it is spread over frames.
constexpr std::uint16_t first_templates(const TrackerLimits& limits) {
  const TemplatePlacementTuning& t = kTemplatePlacementTuning;
  const int part = larger(limits.patches / t.start_divisor, t.least_at_start);
  return static_cast<std::uint16_t>(smaller(part, limits.patches));
}
/// First slot of key frame k; that of k + 1 ends it. Frame 0 is key frame 0.
constexpr std::size_t first_slot(const TrackerLimits& limits, std::size_t k) {
  if (k == 0) return 0;
  const std::size_t each = limits.key_frames > 0 ? limits.key_patches / limits.key_frames : 0;
  return limits.patches + (k - 1) * each;
}
constexpr std::size_t all_slots(const TrackerLimits& limits) {
  return first_slot(limits, std::size_t{limits.key_frames} + 1);
}

constexpr std::size_t edge_points(const TrackerLimits& limits) {
  return limits.edges == nullptr ? 0 : std::size_t{limits.curve_points} + limits.silhouette_points;
}
/// Observations of a frame, at most, but for alternatives.
constexpr std::size_t all_observations(const TrackerLimits& limits) {
  return all_slots(limits) + edge_points(limits);
}
/// Observations that take as much work as the model's springs.
inline std::size_t spring_rows(const Model& model, const TrackerLimits& limits) {
  return limits.stretch == nullptr ? 0 : limits.stretch->work_rows(model);
}
/// The budget of a frame, in the unit of WorkCosts. \param springs  spring_rows of the model, here and below.
constexpr float most_frame_work(const TrackerLimits& limits, const WorkCosts& costs, std::size_t springs) {
  const TrackerTuning& t = kTrackerTuning;
  return scaled_px(limits, t.most_steps_a_template) * costs.search_step *
             static_cast<float>(all_slots(limits)) +
         t.most_passes * costs.row * static_cast<float>(all_observations(limits)) +
         t.most_spring_passes * costs.row * static_cast<float>(springs) +
         t.most_factorisations * costs.factorisation + (limits.person != nullptr ? t.most_for_person : 0.0f);
}
/// The last passes of a frame's solves, which they make whatever is left of the budget; in the unit of WorkCosts.
constexpr float last_passes_work(const TrackerLimits& limits, const WorkCosts& costs, std::size_t springs) {
  return costs.row * static_cast<float>(static_cast<std::size_t>(kTemplateMatchTuning.rounds) *
                                        (all_observations(limits) + springs));
}
/// Of a key frame, at most, in the unit of WorkCosts. \param tries  places tried for each slot.
constexpr float key_frame_work(const TrackerLimits& limits, const WorkCosts& costs, std::size_t tries) {
  const TrackerTuning& t = kTrackerTuning;
  const std::size_t slots = first_slot(limits, 2) - first_slot(limits, 1);
  return t.corner_pixel * static_cast<float>(region_width(limits)) *
             static_cast<float>(region_height(limits)) +
         t.corner_vertex * static_cast<float>(limits.vertices) +
         costs.capture * static_cast<float>(tries * slots);
}
constexpr std::size_t all_points(const TrackerLimits& limits) {
  return all_slots(limits) + limits.markers + edge_points(limits);
}

}  // namespace pliant
