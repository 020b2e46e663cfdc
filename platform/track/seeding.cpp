// Which surface points are tracked: corners of the picture that lie on the visible surface.
#include "track/surface_offset.hpp"
#include "track/tracker_sizes.hpp"

namespace pliant {

namespace {
/// Of the surface to the camera, where a patch is captured: near the outline there is background in its window.
constexpr float kLeastFacing = 0.4f;
}  // namespace

Status Tracker::place_markers(Span<const Vec2> markers) {
  marker_count_ = 0;
  for (Vec2 x : markers) {
    Vec2 uv;
    if (!is_finite(x) || estimator_.surface_at(x, &uv) < 0) return Status::bad_argument;
    // Not only beside the mesh: in an eye or a mouth it may span what the surface does not.
    if (!find_offset(estimator_.view(), estimator_.lens(), estimator_.surface_point(uv), x,
                     &marker_offsets_[marker_count_]))
      return Status::bad_argument;
    const Status status = estimator_.add_point(uv, &marker_ids_[marker_count_]);
    if (status != Status::ok) return status;
    ++marker_count_;
  }
  return Status::ok;
}

/// Cells of the region under the faces that turn to the camera.
void Tracker::mark_visible_cells(int cell_px) {
  const int across = corner_cells(region_width(limits_), cell_px),
            down = corner_cells(region_height(limits_), cell_px);
  for (int i = 0; i < across * down; ++i) cells_[i] = 0;
  const Mesh& mesh = estimator_.mesh();
  const Vec2* image = estimator_.vertex_images();
  const float per_cell = 1.0f / static_cast<float>(cell_px);
  const auto cell = [per_cell](float x, int count) {
    return static_cast<int>(clamp(x * per_cell, 0, static_cast<float>(count - 1)));
  };
  for (FaceId f : mesh.faces()) {
    if (!faces_camera(mesh, image, f)) continue;
    const Vec2 a = estimator_.vertex_seen(mesh.corner(f, 0)) - origin_,
               b = estimator_.vertex_seen(mesh.corner(f, 1)) - origin_,
               c = estimator_.vertex_seen(mesh.corner(f, 2)) - origin_;
    const int i1 = cell(max(a.x, max(b.x, c.x)), across), j1 = cell(max(a.y, max(b.y, c.y)), down);
    for (int j = cell(min(a.y, min(b.y, c.y)), down); j <= j1; ++j)
      for (int i = cell(min(a.x, min(b.x, c.x)), across); i <= i1; ++i) cells_[j * across + i] = 1;
  }
}

/// Takes away the cells in which a patch was seen.
void Tracker::clear_cells_in_use(int cell_px) {
  const int across = corner_cells(region_width(limits_), cell_px);
  for (std::size_t k = 0; k < slot_count_; ++k) {
    const Slot& slot = slots_[k];
    if (!slot.is_used || !slot.was_seen || !is_in_region(slot.seen)) continue;
    const Vec2 x = slot.seen - origin_;
    cells_[static_cast<int>(x.y) / cell_px * across + static_cast<int>(x.x) / cell_px] = 0;
  }
}

bool Tracker::is_far_from_others(Vec2 x, float min_distance) {
  const auto nearer = [x](Vec2 other, float distance) {
    return dot(x - other, x - other) < distance * distance;
  };
  for (std::size_t k = 0; k < slot_count_; ++k)
    if (slots_[k].is_used && slots_[k].was_seen && nearer(slots_[k].seen, min_distance)) return false;
  for (std::size_t k = 0; k < marker_count_; ++k) {
    Vec2 marker_x;
    if (!marker(k, &marker_x) || nearer(marker_x, options_.marker_exclusion_px)) return false;
  }
  return true;
}

/// Takes on the surface under x (px of the frame) as the point of a free slot.
bool Tracker::seed(Vec2 x, float min_distance, std::size_t slot) {
  if (!is_far_from_others(x, min_distance)) return false;
  Vec2 uv;
  if (estimator_.surface_at(x, &uv) != 0 || !estimator_.model().is_on_surface(uv)) return false;
  std::uint16_t id;
  if (estimator_.add_point(uv, &id) != Status::ok) return false;
  const Prediction p = estimator_.predict(id);
  if (!p.visible || p.facing < kLeastFacing ||
      patches_.capture(static_cast<int>(slot), current_, x - origin_) != PatchStatus::ok) {
    estimator_.remove_point(id);
    return false;
  }
  Slot fresh;
  fresh.id = id;
  fresh.owner = static_cast<std::uint16_t>(slot);
  fresh.reference = fresh.looked_with = p.jacobian;
  fresh.seen = fresh.expected = fresh.looked_at = x;
  fresh.is_used = fresh.was_seen = true;
  slots_[slot] = fresh;
  return true;
}

/// Fills the slots [first, end) as far as there is texture: as far apart as the free surface allows, then closer.
void Tracker::seed_patches(std::size_t first, std::size_t end) {
  CornerOptions options = corner_options(limits_);
  mark_visible_cells(options.cell_px);
  clear_cells_in_use(options.cell_px);
  const auto cells = static_cast<std::size_t>(corner_cells(region_width(limits_), options.cell_px)) *
                     static_cast<std::size_t>(corner_cells(region_height(limits_), options.cell_px));
  std::size_t marked = 0;
  for (std::size_t i = 0; i < cells; ++i) marked += cells_[i];
  const float area = static_cast<float>(marked) * static_cast<float>(options.cell_px * options.cell_px);
  float spacing = square_root(area / static_cast<float>(end - first));
  for (int round = 0; round < 6 && first < end; ++round, spacing *= 0.7f) {
    options.min_distance_px = clamp(spacing, 2, 256);
    Arena scratch(scratch_, scratch_bytes_);
    int found = 0;
    if (find_corners(current_.level(0), options, {cells_, cells}, scratch, {corners_, limits_.patches},
                     found) != Status::ok)
      return;
    for (int i = 0; i < found && first < end; ++i)
      if (seed(corners_[i].x + origin_, spacing, first)) ++first;
  }
}

void Tracker::release_slot(std::size_t k) {
  Slot& slot = slots_[k];
  if (!slot.is_used) return;
  if (slot.owner != k) {
    slots_[slot.owner].second = kNoSlot;
  } else {
    estimator_.remove_point(slot.id);
    if (slot.second != kNoSlot) {
      patches_.release(slot.second);
      slots_[slot.second].is_used = false;
    }
  }
  patches_.release(static_cast<int>(k));
  slot.is_used = false;
}

}  // namespace pliant
