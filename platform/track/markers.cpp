#include "track/markers.hpp"

#include "track/surface_offset.hpp"

namespace pliant {

void Markers::lay_out(Arena& arena, std::size_t capacity) {
  capacity_ = capacity;
  count_ = 0;
  arena.count_as(Purpose::points);
  ids_ = arena.take<std::uint16_t>(capacity);
  offsets_ = arena.take<Vec3>(capacity);
}

Status Markers::place(Estimator& estimator, Span<const Vec2> markers, float exclusion_px) {
  count_ = 0;
  exclusion_px_ = exclusion_px;
  if (markers.count > capacity_) return Status::capacity;
  for (Vec2 x : markers) {
    Vec2 uv;
    if (estimator.surface_at(x, &uv) < 0) return Status::bad_argument;
    // Also for a marker on the mesh: over an eye or a mouth the mesh may span what the surface leaves open.
    if (!find_offset(estimator.view(), estimator.lens(), estimator.surface_point(uv), x, &offsets_[count_]))
      return Status::bad_argument;
    const Status status = estimator.add_point(uv, &ids_[count_]);
    if (status != Status::ok) return status;
    ++count_;
  }
  return Status::ok;
}

std::size_t Markers::save(const Estimator& estimator, MarkerPlace* places) const {
  for (std::size_t k = 0; k < count_; ++k) places[k] = {estimator.point_uv(ids_[k]), offsets_[k]};
  return count_;
}

void Markers::restore(Estimator& estimator, const MarkerPlace* places, std::size_t count) {
  PLIANT_ASSERT(count <= capacity_);
  for (count_ = 0; count_ < count; ++count_) {
    if (estimator.add_point(places[count_].uv, &ids_[count_]) != Status::ok) return;
    offsets_[count_] = places[count_].offset;
  }
}

void Markers::project_all(const View& view, Estimator& estimator, Vec2* x) const {
  for (std::size_t k = 0; k < count_; ++k)
    x[k] =
        place_in(view, estimator.lens(), estimator.surface_point(estimator.point_uv(ids_[k])) + offsets_[k]);
}

void Markers::keep_all(const View& view, Estimator& estimator, const Vec2* x) {
  for (std::size_t k = 0; k < count_; ++k) {
    Vec3 moved;
    const Vec3 before = estimator.surface_point(estimator.point_uv(ids_[k])) + offsets_[k];
    if (x[k].x > kNowhere.x && find_offset(view, estimator.lens(), before, x[k], &moved))
      offsets_[k] = offsets_[k] + moved;
  }
}

bool Markers::position(std::size_t k, Estimator& estimator, Vec2* x) const {
  return k < count_ && project_beside(estimator, estimator.point_uv(ids_[k]), offsets_[k], x);
}

bool Markers::are_far_from(Vec2 x, Estimator& estimator) const {
  for (std::size_t k = 0; k < count_; ++k) {
    Vec2 at;
    if (!position(k, estimator, &at)) continue;
    if (dot(x - at, x - at) < exclusion_px_ * exclusion_px_) return false;
  }
  return true;
}

}  // namespace pliant
