#include "track/template_store.hpp"

#include "track/template_tuning.hpp"
#include "track/tracker_sizes.hpp"
#include "vision/strain.hpp"

namespace pliant {

namespace {

PatchLimits patch_limits(const TrackerLimits& limits) {
  PatchLimits p;
  p.slots = static_cast<int>(all_slots(limits));
  p.window = limits.patch_window;
  p.levels = limits.pyramid_levels;
  p.margin = limits.patch_margin;
  p.keeps_templates = limits.keeps_templates;
  return p;
}

std::int8_t to_bend(float mm) {
  constexpr int kMost = 127;
  return static_cast<std::int8_t>(static_cast<int>(clamp(kBendUnits * mm, -kMost, kMost) + kMost + 0.5f) -
                                  kMost);
}

/// The paraboloid that is nearest to the surface around a point (least squares on 3 x 3 points), in the axes of the image
/// that shows it by t.reference.
void measure_bend(Template& t, Vec2 uv, float window_px, Estimator& estimator) {
  const SurfaceFrame middle = estimator.surface_frame(uv, estimator.parameters().data);
  const Vec3 normal = cross(middle.pu, middle.pv), towards = camera_direction(estimator.view());
  const float facing = dot(normal, towards);
  if (facing == 0) return;
  const Mat2 to_uv = inverse(t.reference);
  const float reach = kTemplateStoreTuning.bend_reach * window_px;
  const auto step_of = [](std::size_t i) {
    return Vec2{static_cast<float>(i % 3) - 1, static_cast<float>(i / 3) - 1};
  };
  Vec2 around[9];
  Vec3 at[9];
  for (std::size_t i = 0; i < 9; ++i) {
    const Vec2 to = uv + to_uv * (reach * step_of(i));
    around[i] = {clamp(to.x, 0, 1), clamp(to.y, 0, 1)};
  }
  estimator.surface_points({around, 9}, at);
  float xx = 0, xy = 0, yy = 0;
  for (std::size_t i = 0; i < 9; ++i) {
    const float x = step_of(i).x, y = step_of(i).y;
    const float depth = dot(normal, middle.p - at[i]) / facing;  // mm behind the tangent plane
    xx += (3 * x * x - 2) * depth;
    xy += x * y * depth;
    yy += (3 * y * y - 2) * depth;
  }
  // Mean square in the window over that of `reach`.
  const float per = window_px * window_px / (12 * reach * reach);
  t.bend[0] = to_bend(per / 6 * xx);
  t.bend[1] = to_bend(per / 8 * xy);
  t.bend[2] = to_bend(per / 6 * yy);
}

/// How much the light may have changed over a window since the key frame, as PatchOptions::ramp_sd. \param of_mm  image of one
/// mm away from its camera: as many px as the sine of the turn since then, times the scale.
float ramp_sd(Vec2 of_mm, const KeyDepths& depths) {
  if (depths.view == nullptr) return 0;
  const float mm_per_px = 1 / depths.view->s;
  const float sd = kTemplateStoreTuning.ramp_grey_per_mm * mm_per_px * (mm_per_px * length(of_mm));
  return sd < kTemplateStoreTuning.least_ramp_sd ? 0 : sd;
}

}  // namespace

float strain(const Mat2& now, const Mat2& reference) {
  return strain(now * inverse(reference));
}

void TemplateStore::lay_out(Arena& arena, const TrackerLimits& limits) {
  count_ = static_cast<std::uint16_t>(all_slots(limits));
  of_frame_0_ = static_cast<std::uint16_t>(first_slot(limits, 1));
  of_key_ = static_cast<std::uint16_t>(first_slot(limits, 2) - first_slot(limits, 1));
  window_px_ = limits.patch_window;
  side_px_ = static_cast<std::uint8_t>(limits.patch_window + 2 * limits.patch_margin);
  arena.count_as(Purpose::patches);
  patches_.lay_out(arena, patch_limits(limits));
  arena.count_as(Purpose::points);
  templates_ = arena.take<Template>(count_);
}

void TemplateStore::clear() {
  for (std::size_t k = 0; k < count_; ++k) templates_[k].is_used = false;
}

bool TemplateStore::capture(std::size_t slot, Estimator& estimator, const FrameRegion& region, Vec2 x,
                            Vec2 uv) {
  PLIANT_ASSERT(slot < count_ && !templates_[slot].is_used);
  estimator.refine_uv(x, &uv);
  if (!estimator.model().is_on_surface(uv)) return false;
  std::uint16_t id;
  if (estimator.add_point(uv, &id) != Status::ok) return false;
  const Prediction p = estimator.predict(id);
  if (!p.visible || p.facing < kTemplateStoreTuning.least_facing ||
      (check_.accepts != nullptr && !check_.accepts(check_.state, region, uv, p)) ||
      patches_.capture(static_cast<int>(slot), region.pyramid(), x - region.origin()) != PatchStatus::ok) {
    estimator.remove_point(id);
    return false;
  }
  templates_[slot] = captured(id, slot, p, estimator);
  templates_[slot].found_at = x;
  templates_[slot].was_found = true;
  return true;
}

Template TemplateStore::captured(std::uint16_t id, std::size_t first, const Prediction& seen,
                                 Estimator& estimator) const {
  Template fresh;
  fresh.id = id;
  fresh.first = static_cast<std::uint16_t>(first);
  fresh.reference = seen.jacobian;
  fresh.is_used = true;
  measure_bend(fresh, estimator.point_uv(id), window_px_, estimator);
  return fresh;
}

std::size_t TemplateStore::capture_second(std::size_t points, std::size_t first, std::size_t end,
                                          Estimator& estimator, const FrameRegion& region) {
  PLIANT_ASSERT(points <= count_ && end <= count_);
  for (std::size_t k = 0; k < points && first < end; ++k) {
    Template& point = templates_[k];
    if (!point.is_used || !point.was_found || point.second != kNoSlot || point.frames_apart > 0) continue;
    if (point.correlation > kTemplateStoreTuning.second_template_correlation) continue;
    const Prediction p = estimator.predict(point.id);
    if (!p.visible || patches_.capture(static_cast<int>(first), region.pyramid(),
                                       point.found_at - region.origin()) != PatchStatus::ok)
      continue;
    templates_[first] = captured(point.id, k, p, estimator);
    point.second = static_cast<std::uint16_t>(first++);
  }
  return first;
}

void TemplateStore::release(std::size_t slot, Estimator& estimator) {
  PLIANT_ASSERT(slot < count_);
  Template& t = templates_[slot];
  if (!t.is_used) return;
  if (t.first != slot) {
    templates_[t.first].second = kNoSlot;
  } else {
    estimator.remove_point(t.id);
    if (t.second != kNoSlot) templates_[t.second].is_used = false;
  }
  t.is_used = false;
}

std::size_t TemplateStore::key_of(std::size_t slot) const {
  return slot < of_frame_0_ ? 0 : 1 + (slot - of_frame_0_) / of_key_;
}

/// Mean depth of what the window shows behind its middle, mm. The warp stretches the window over the template, but not
/// beyond what is stored.
float TemplateStore::depth(const Template& t, const Mat2& to_template) const {
  const float side = static_cast<float>(side_px_) / static_cast<float>(window_px_);
  const Mat2& b = to_template;
  const float xx = b.a * b.a + b.b * b.b, yy = b.c * b.c + b.d * b.d;
  const float most_xx = min(xx, side * side), most_yy = min(yy, side * side);
  const float xy = square_root(most_xx * most_yy / max(xx * yy, 1e-12f)) * (b.a * b.c + b.b * b.d);
  const float mm = (most_xx * t.bend[0] + 2 * xy * t.bend[1] + most_yy * t.bend[2]) / kBendUnits;
  return clamp(mm, 0, kTemplateStoreTuning.most_depth_mm);
}

PatchResult TemplateStore::match(std::size_t slot, const FrameRegion& region, Vec2 start,
                                 const Mat2& jacobian, const KeyDepths& depths, PatchOptions options) {
  PLIANT_ASSERT(is_first(slot));
  const Template& first = templates_[slot];
  std::size_t which = slot;
  if (first.second != kNoSlot &&
      strain(jacobian, templates_[first.second].reference) < strain(jacobian, first.reference))
    which = first.second;
  const Mat2 warp = jacobian * inverse(templates_[which].reference);
  const Vec2 of_mm = depths.of(key_of(which)), shift = depth(templates_[which], inverse(warp)) * of_mm;
  options.ramp_sd = ramp_sd(of_mm, depths);
  PatchResult result = patches_.track(static_cast<int>(which), region.pyramid(),
                                      start + shift - region.origin(), warp, options);
  result.x = result.x - shift;
  return result;
}

PatchResult TemplateStore::match_from_previous(Vec2 x, const FrameRegion& region, Vec2 start,
                                               const PatchOptions& options) {
  PLIANT_ASSERT(region.keeps_previous());
  return patches_.track_between(region.previous_pyramid(), x - region.previous_origin(), region.pyramid(),
                                start - region.origin(), options);
}

}  // namespace pliant
