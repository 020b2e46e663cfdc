#include "track/landmark_offsets.hpp"

#include <limits>

#include "base/arrays.hpp"
#include "model/ibug_names.hpp"
#include "track/landmark_fit.hpp"
#include "track/surface_offset.hpp"

namespace pliant {

namespace {

constexpr float kIsPending = std::numeric_limits<float>::infinity();  // as z: no offset has it

bool is_at(const Landmark& landmark, Vec2 uv) {
  return landmark.u == uv.x && landmark.v == uv.y;
}

}  // namespace

void LandmarkOffsets::lay_out(Arena& arena, const Model& model) {
  arena.count_as(Purpose::state);
  values_ = arena.take_span<Vec3>(model.landmarks().count);
}

void LandmarkOffsets::clear() {
  for (Vec3& value : values_) value = {};
}

void LandmarkOffsets::set(Span<const Vec3> offsets) {
  PLIANT_ASSERT(offsets.count == values_.count);
  copy(offsets.data, values_.count, values_.data);
}

void LandmarkOffsets::place(Vec2 uv, Vec2 x, Estimator& estimator) {
  const Vec3 surface = estimator.surface_point(uv);
  for (std::size_t k = 0; k < values_.count; ++k)
    if (is_at(estimator.model().landmarks()[k], uv))
      find_offset(estimator.view(), estimator.lens(), surface, x, &values_[k]);
}

void LandmarkOffsets::set_pending(Span<const Correspondence> places, const Model& model) {
  clear();
  for (const Correspondence& place : places)
    for (std::size_t k = 0; k < values_.count; ++k)
      if (is_at(model.landmarks()[k], place.uv)) values_[k] = {place.x.x, place.x.y, kIsPending};
}

void LandmarkOffsets::set_pending(Span<const Vec2> places, const Model& model) {
  PLIANT_ASSERT(places.count == values_.count);
  const Landmark* const all = model.landmarks().data;
  for (std::size_t k = 0; k < values_.count; ++k) {
    if (!is_ibug_landmark(all[k].name)) continue;
    for (std::size_t same = 0; same < values_.count; ++same)
      if (is_at(all[same], all[k].uv())) values_[same] = {places[k].x, places[k].y, kIsPending};
  }
}

void LandmarkOffsets::place_pending(Estimator& estimator) {
  for (std::size_t k = 0; k < values_.count; ++k) {
    const Vec3 pending = values_[k];
    if (pending.z != kIsPending) continue;
    values_[k] = {};
    find_offset(estimator.view(), estimator.lens(),
                estimator.surface_point(estimator.model().landmarks()[k].uv()), {pending.x, pending.y},
                &values_[k]);
  }
}

void LandmarkOffsets::project_all(const View& view, Estimator& estimator, Vec2* x) const {
  for (std::size_t k = 0; k < values_.count; ++k)
    x[k] = place_in(view, estimator.lens(),
                    estimator.surface_point(estimator.model().landmarks()[k].uv()) + values_[k]);
}

void LandmarkOffsets::keep_all(const View& view, Estimator& estimator, const Vec2* x, Vec3* moved) {
  for (std::size_t k = 0; k < values_.count; ++k) {
    moved[k] = {};
    const Vec3 before = estimator.surface_point(estimator.model().landmarks()[k].uv()) + values_[k];
    if (x[k].x > kNowhere.x) find_offset(view, estimator.lens(), before, x[k], &moved[k]);
    values_[k] = values_[k] + moved[k];
  }
}

bool LandmarkOffsets::project(std::size_t k, Estimator& estimator, Vec2* x) const {
  PLIANT_ASSERT(k < values_.count);
  return project_beside(estimator, estimator.model().landmarks()[k].uv(), values_[k], x);
}

}  // namespace pliant
