#include "pliant/patch_tracker.hpp"

#include "vision/patch_result.hpp"
#include "vision/patch_search.hpp"

namespace pliant {

using patch::contains;
using patch::SearchState;
using patch::TemplateSource;

namespace {

constexpr int kMaxSlots = 16384, kMaxMargin = 16;

bool is_valid(const PatchLimits& l) {
  return l.slots >= 0 && l.slots <= kMaxSlots && patch::is_window(l.window) && l.levels >= 1 &&
         l.levels <= Pyramid::kMaxLevels && l.margin >= 0 && l.margin <= kMaxMargin;
}

// A warp that is finite, keeps orientation, and whose entries and inverse are bounded.
bool is_plausible(const Mat2& w) {
  constexpr float kMost = 4.0f;
  const float det = determinant(w);
  return det >= 1.0f / (kMost * kMost) && det <= kMost * kMost && magnitude(w.a) <= kMost &&
         magnitude(w.b) <= kMost && magnitude(w.c) <= kMost && magnitude(w.d) <= kMost;
}

PatchResult failure(PatchStatus status, Vec2 start) {
  PatchResult r;
  r.status = status;
  r.x = start;
  return r;
}

}  // namespace

Status PatchTracker::create(Arena& arena, const PatchLimits& limits) {
  return is_valid(limits) ? create_in(arena, *this, limits) : Status::bad_argument;
}

void PatchTracker::lay_out(Arena& arena, const PatchLimits& limits) {
  PLIANT_ASSERT(is_valid(limits));
  limits_ = limits;
  state_ = create_part<SearchState>(arena, limits);
}

PatchStatus PatchTracker::capture(int slot, const Pyramid& pyramid, Vec2 x, const PatchOptions& options) {
  if (state_ == nullptr || !state_->slots.is_slot(slot) || pyramid.levels() == 0 || !is_finite(x))
    return PatchStatus::bad_argument;
  if (!contains(pyramid.level(0), x, limits_.window / 2)) return PatchStatus::outside_image;
  const bool accepts_edges = options.normal_flow != nullptr;
  load_level(*state_, TemplateSource::around(pyramid, x), 0, accepts_edges);
  if (!patch::has_texture(state_->work, accepts_edges)) return PatchStatus::flat;
  state_->slots.store(slot, pyramid, x);
  return PatchStatus::ok;
}

void PatchTracker::release(int slot) {
  if (is_captured(slot)) state_->slots.release(slot);
}

bool PatchTracker::is_captured(int slot) const {
  return state_ != nullptr && state_->slots.is_captured(slot);
}

PatchResult PatchTracker::track(int slot, const Pyramid& current, Vec2 start, const Mat2& warp,
                                const PatchOptions& options) {
  if (state_ == nullptr || !state_->slots.is_slot(slot) || !is_plausible(warp))
    return failure(PatchStatus::bad_argument, start);
  if (!is_captured(slot)) return failure(PatchStatus::empty_slot, start);
  return search(*state_, TemplateSource::of_slot(slot, warp, limits_.window), current, start, options);
}

PatchResult PatchTracker::track_between(const Pyramid& previous, Vec2 x, const Pyramid& current, Vec2 start,
                                        const PatchOptions& options) {
  if (state_ == nullptr || previous.levels() == 0 || !is_finite(x))
    return failure(PatchStatus::bad_argument, start);
  const int radius = limits_.window / 2;
  if (!contains(previous.level(0), x, radius)) return failure(PatchStatus::outside_image, start);
  PatchResult result = search(*state_, TemplateSource::around(previous, x), current, start, options);
  if (result.status != PatchStatus::ok || !(options.max_return_px > 0)) return result;
  if (!contains(current.level(0), result.x, radius)) {
    result.status = PatchStatus::outside_image;
    result.x = start;
    return result;
  }
  const TemplateSource backward = TemplateSource::around(current, result.x);
  const PatchResult back = search(*state_, backward, previous, result.x - (start - x), options);
  result.iterations += back.iterations;
  result.return_px = patch::informed_distance(back.x - x, result);
  if (back.status != PatchStatus::ok || result.return_px > options.max_return_px)
    result.status = PatchStatus::inconsistent;
  return result;
}

}  // namespace pliant
