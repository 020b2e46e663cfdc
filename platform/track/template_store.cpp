#include "track/template_store.hpp"

#include "track/template_tuning.hpp"
#include "track/tracker_sizes.hpp"

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

}  // namespace

float strain(const Mat2& now, const Mat2& reference) {
  const Mat2 w = now * inverse(reference);
  return max(max(magnitude(w.a - 1), magnitude(w.d - 1)), max(magnitude(w.b), magnitude(w.c)));
}

void TemplateStore::lay_out(Arena& arena, const TrackerLimits& limits) {
  count_ = all_slots(limits);
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
  Template fresh;
  fresh.id = id;
  fresh.first = static_cast<std::uint16_t>(slot);
  fresh.reference = p.jacobian;
  fresh.found_at = x;
  fresh.is_used = fresh.was_found = true;
  templates_[slot] = fresh;
  return true;
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
    Template fresh;
    fresh.id = point.id;
    fresh.first = static_cast<std::uint16_t>(k);
    fresh.reference = p.jacobian;
    fresh.is_used = true;
    templates_[first] = fresh;
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
    if (t.second != kNoSlot) {
      patches_.release(t.second);
      templates_[t.second].is_used = false;
    }
  }
  patches_.release(static_cast<int>(slot));
  t.is_used = false;
}

PatchResult TemplateStore::match(std::size_t slot, const FrameRegion& region, Vec2 start,
                                 const Mat2& jacobian, const PatchOptions& options) {
  PLIANT_ASSERT(is_first(slot));
  const Template& first = templates_[slot];
  std::size_t which = slot;
  if (first.second != kNoSlot &&
      strain(jacobian, templates_[first.second].reference) < strain(jacobian, first.reference))
    which = first.second;
  return patches_.track(static_cast<int>(which), region.pyramid(), start - region.origin(),
                        jacobian * inverse(templates_[which].reference), options);
}

PatchResult TemplateStore::match_from_previous(Vec2 x, const FrameRegion& region, Vec2 start,
                                               const PatchOptions& options) {
  PLIANT_ASSERT(region.keeps_previous());
  return patches_.track_between(region.previous_pyramid(), x - region.previous_origin(), region.pyramid(),
                                start - region.origin(), options);
}

}  // namespace pliant
