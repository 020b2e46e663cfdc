#include "track/template_placement.hpp"

#include "base/extent.hpp"
#include "pliant/visibility.hpp"
#include "track/template_tuning.hpp"
#include "track/tracker_sizes.hpp"

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

constexpr float kNoFace = 1e30f;

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
  const CornerOptions options = corner_options(limits);
  const int cells = corner_cells(region_width(limits), options.cell_px) *
                    corner_cells(region_height(limits), options.cell_px);
  return corner_scratch_bytes(region_width(limits), region_height(limits), options) +
         static_cast<std::size_t>(cells) * sizeof(Under) + Arena::kAlignment;
}

std::size_t TemplatePlacement::place(TemplateStore& templates, Estimator& estimator,
                                     const FrameRegion& region, const Markers& markers, std::size_t first,
                                     std::size_t end, std::size_t tries) {
  PLIANT_ASSERT(end <= templates.count());
  const std::size_t free = mark_free_cells(templates, estimator, region);
  Arena scratch(scratch_.data, scratch_.count);
  corners::Grid grid;
  const auto cells = static_cast<std::size_t>(across_) * static_cast<std::size_t>(down_);
  const float area = static_cast<float>(free) * static_cast<float>(options_.cell_px * options_.cell_px);
  float spacing = square_root(area / static_cast<float>(end - first));
  if (corners::scan_cells(region.pyramid().level(0), options_, {cells_, cells}, scratch, &grid) != Status::ok)
    return 0;
  std::size_t tried = 0;
  Under* const under = scratch.take<Under>(cells);
  find_mesh_under_corners(estimator, region, grid, under);
  for (int pass = 0; pass < kTuning.passes && first < end && tried < tries;
       ++pass, spacing *= kTuning.spacing_factor) {
    const float distance = clamp(spacing, kTuning.least_spacing_px, kTuning.most_spacing_px);
    const int found = corners::choose_corners(grid, options_.quality, distance, corners_);
    for (int i = 0; i < found && first < end && tried < tries; ++i) {
      const Vec2 at = corners_[static_cast<std::size_t>(i)].x, x = at + region.origin();
      const int of_corner = cell_of(at);
      std::uint8_t& cell = cells_[of_corner];
      const Under& mesh = under[of_corner];
      if (cell == kFailed || mesh.depth == kNoFace || !is_far_from_found(templates, x, spacing) ||
          !markers.are_far_from(x, estimator))
        continue;
      ++tried;
      if (templates.capture(first, estimator, region, x, mesh.uv))
        ++first;
      else
        cell = kFailed;
    }
  }
  return tried;
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

/// The cells that a face's bounding box in the image touches.
TemplatePlacement::CellBox TemplatePlacement::cells_of(const Estimator& estimator, const FrameRegion& region,
                                                       FaceId face, float margin_px) const {
  const float per_cell = 1.0f / static_cast<float>(options_.cell_px);
  const auto cell = [per_cell](float x, int count) {
    return static_cast<int>(clamp(x * per_cell, 0, static_cast<float>(count - 1)));
  };
  Extent e;
  for (int k = 0; k < 3; ++k)
    e.include(estimator.vertex_seen(estimator.mesh().corner(face, k)) - region.origin());
  return {cell(e.low.x - margin_px, across_), cell(e.low.y - margin_px, down_),
          cell(e.high.x + margin_px, across_), cell(e.high.y + margin_px, down_)};
}

/// Marks the cells under faces of the mesh that turn to the camera; clears the others.
void TemplatePlacement::mark_visible_cells(const Estimator& estimator, const FrameRegion& region) {
  for (int i = 0; i < across_ * down_; ++i) cells_[i] = 0;
  const Mesh& mesh = estimator.mesh();
  for (FaceId f : mesh.faces()) {
    if (!faces_camera(mesh, estimator.vertex_images(), f)) continue;
    const CellBox box = cells_of(estimator, region, f, 0);
    for (int j = box.j0; j <= box.j1; ++j)
      for (int i = box.i0; i <= box.i1; ++i) cells_[j * across_ + i] = 1;
  }
}

/// For each cell's corner the point of the mesh under it; of several faces that of the one nearest to the camera. One walk over
/// the faces for all corners: to scan them for each corner took a third of a start with 1,900 vertices.
void TemplatePlacement::find_mesh_under_corners(const Estimator& estimator, const FrameRegion& region,
                                                const corners::Grid& grid, Under* under) const {
  for (int i = 0; i < grid.count(); ++i) under[i] = {{}, kNoFace};
  const Mesh& mesh = estimator.mesh();
  const Vec2* const image = estimator.vertex_images();
  const Projector projector(estimator.view(), true);
  const Lens& lens = estimator.lens();
  for (FaceId f : mesh.faces()) {
    if (!faces_camera(mesh, image, f)) continue;
    const VertexId v[3] = {mesh.corner(f, 0), mesh.corner(f, 1), mesh.corner(f, 2)};
    const CellBox box = cells_of(estimator, region, f, lens.is_none() ? 0 : kTuning.bend_px);
    for (int j = box.j0; j <= box.j1; ++j)
      for (int i = box.i0; i <= box.i1; ++i) {
        const int k = j * across_ + i;
        const corners::Cell& corner = grid.cells[k];
        if (!(corner.score > 0)) continue;
        const Vec2 seen{static_cast<float>(corner.x), static_cast<float>(corner.y)};
        float w[3];
        if (nearest_on_triangle(image[v[0]], image[v[1]], image[v[2]], lens.undistort(seen + region.origin()),
                                w) != 0)
          continue;
        const Vec3* const at = estimator.vertex_positions();
        const Vec3 p = w[0] * at[v[0]] + (w[1] * at[v[1]] + w[2] * at[v[2]]);
        const float depth = projector.rotated(p).z;
        Vec2 unused;
        if (depth >= under[k].depth || !projector.project(p, &unused)) continue;
        under[k] = {w[0] * mesh.uv(v[0]) + (w[1] * mesh.uv(v[1]) + w[2] * mesh.uv(v[2])), depth};
      }
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
