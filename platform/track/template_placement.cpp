#include "track/template_placement.hpp"

#include "track/template_tuning.hpp"
#include "track/tracker_sizes.hpp"
#include "vision/corner_grid.hpp"

namespace pliant {

namespace {

constexpr const TemplatePlacementTuning& kTuning = kTemplatePlacementTuning;

CornerOptions corner_options(const TrackerLimits& limits) {
  CornerOptions o;
  o.cell_px = cell_px_of(limits);
  o.min_score = kTuning.least_score;
  o.quality = 0;
  o.min_ratio = kTuning.least_ratio;
  return o;
}

/// Of a cell whose corner cannot be captured: not on the surface, or turned away. Later passes leave it out.
constexpr std::uint8_t kFailed = 2;

bool is_far_from_found(const TemplateStore& templates, Vec2 x, float min_distance) {
  for (std::size_t k = 0; k < templates.count(); ++k) {
    if (!templates[k].is_used || !templates[k].was_found) continue;
    const Vec2 off = x - templates[k].found_at;
    if (dot(off, off) < min_distance * min_distance) return false;
  }
  return true;
}

}  // namespace

void TemplatePlacement::lay_out(Arena& arena, const TrackerLimits& limits) {
  options_ = corner_options(limits);
  across_ = corner_cells(region_width(limits), options_.cell_px);
  down_ = corner_cells(region_height(limits), options_.cell_px);
  arena.count_as(Purpose::corners);
  corners_ = arena.take_span<Corner>(limits.patches);
  cells_ = arena.take<std::uint8_t>(static_cast<std::size_t>(across_) * static_cast<std::size_t>(down_));
}

std::size_t TemplatePlacement::scratch_bytes(const TrackerLimits& limits) {
  return corner_scratch_bytes(region_width(limits), region_height(limits), corner_options(limits));
}

void TemplatePlacement::place(TemplateStore& templates, Estimator& estimator, const FrameRegion& region,
                              const Markers& markers, std::size_t first, std::size_t end) {
  PLIANT_ASSERT(end <= templates.count());
  const std::size_t free = mark_free_cells(templates, estimator, region);
  Arena scratch(scratch_.data, scratch_.count);
  corners::Grid grid;
  const auto cells = static_cast<std::size_t>(across_) * static_cast<std::size_t>(down_);
  const float area = static_cast<float>(free) * static_cast<float>(options_.cell_px * options_.cell_px);
  float spacing = square_root(area / static_cast<float>(end - first));
  if (corners::scan_cells(region.pyramid().level(0), options_, {cells_, cells}, scratch, &grid) != Status::ok)
    return;
  for (int pass = 0; pass < kTuning.passes && first < end; ++pass, spacing *= kTuning.spacing_factor) {
    const float distance = clamp(spacing, kTuning.least_spacing_px, kTuning.most_spacing_px);
    const int found = corners::choose_corners(grid, options_.quality, distance, corners_);
    for (int i = 0; i < found && first < end; ++i) {
      const Vec2 at = corners_[static_cast<std::size_t>(i)].x, x = at + region.origin();
      std::uint8_t& cell = cells_[cell_of(at)];
      if (cell == kFailed || !is_far_from_found(templates, x, spacing) || !markers.are_far_from(x, estimator))
        continue;
      if (templates.capture(first, estimator, region, x))
        ++first;
      else
        cell = kFailed;
    }
  }
}

/// Marks the cells in which a template may be captured. \return how many there are.
std::size_t TemplatePlacement::mark_free_cells(const TemplateStore& templates, const Estimator& estimator,
                                               const FrameRegion& region) {
  mark_visible_cells(estimator, region);
  clear_cells_in_use(templates, region);
  std::size_t marked = 0;
  for (int i = 0; i < across_ * down_; ++i) marked += cells_[i];
  return marked;
}

/// Marks the cells under faces of the mesh that turn to the camera; clears the others.
void TemplatePlacement::mark_visible_cells(const Estimator& estimator, const FrameRegion& region) {
  for (int i = 0; i < across_ * down_; ++i) cells_[i] = 0;
  const Mesh& mesh = estimator.mesh();
  const float per_cell = 1.0f / cell_side();
  const auto cell = [per_cell](float x, int count) {
    return static_cast<int>(clamp(x * per_cell, 0, static_cast<float>(count - 1)));
  };
  for (FaceId f : mesh.faces()) {
    if (!faces_camera(mesh, estimator.vertex_images(), f)) continue;
    const Vec2 a = estimator.vertex_seen(mesh.corner(f, 0)) - region.origin(),
               b = estimator.vertex_seen(mesh.corner(f, 1)) - region.origin(),
               c = estimator.vertex_seen(mesh.corner(f, 2)) - region.origin();
    const int i1 = cell(max(a.x, max(b.x, c.x)), across_), j1 = cell(max(a.y, max(b.y, c.y)), down_);
    for (int j = cell(min(a.y, min(b.y, c.y)), down_); j <= j1; ++j)
      for (int i = cell(min(a.x, min(b.x, c.x)), across_); i <= i1; ++i) cells_[j * across_ + i] = 1;
  }
}

void TemplatePlacement::clear_cells_in_use(const TemplateStore& templates, const FrameRegion& region) {
  for (std::size_t k = 0; k < templates.count(); ++k) {
    const Template& t = templates[k];
    if (!t.is_used || !t.was_found || !region.contains(t.found_at)) continue;
    const Vec2 x = t.found_at - region.origin();
    cells_[cell_of(x)] = 0;
  }
}

}  // namespace pliant
