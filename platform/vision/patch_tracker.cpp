// Slots, and the search from coarse to fine.
#include "pliant/patch_tracker.hpp"

#include <cstring>

#include "vision/patch_result.hpp"
#include "vision/patch_work.hpp"

namespace pliant {

using patch::Anchor;
using patch::Kept;
using patch::Surround;
using patch::Work;

namespace {

constexpr int kMaxSlots = 16384, kMaxMargin = 16;
constexpr std::size_t kReadAhead = 64;  // bytes past the last square that kernels may read and do not use

bool is_valid(const PatchLimits& l) {
  return l.slots >= 0 && l.slots <= kMaxSlots && l.window >= patch::kMinWindow &&
         l.window <= patch::kMaxWindow && l.window % 2 == 1 && l.levels >= 1 &&
         l.levels <= Pyramid::kMaxLevels && l.margin >= 0 && l.margin <= kMaxMargin;
}

std::size_t square_bytes(const PatchLimits& l) {
  return static_cast<std::size_t>(patch::surround_side(l)) *
         static_cast<std::size_t>(patch::surround_side(l));
}

bool contains(const ImageView& image, Vec2 x, int margin) {
  const auto m = static_cast<float>(margin);
  return x.x >= m && x.y >= m && x.x <= static_cast<float>(image.width - 1) - m &&
         x.y <= static_cast<float>(image.height - 1) - m;
}

// A warp that is finite, keeps orientation and changes lengths by no more than four.
bool is_plausible(const Mat2& w) {
  constexpr float kMost = 4.0f;
  const float det = determinant(w);
  return det >= 1.0f / (kMost * kMost) && det <= kMost * kMost && magnitude(w.a) <= kMost &&
         magnitude(w.b) <= kMost && magnitude(w.c) <= kMost && magnitude(w.d) <= kMost;
}

constexpr float kCoarseStep = 20;  // by how much larger a step ends all but the last searches

// Warps that move the edge of the window by less, in pixels of a level, are left out; or at full size left to the last
// steps, where these allow for a warp.
constexpr float kNegligible = 0.1f, kNegligibleCoarse = 0.5f, kLeftToLastSteps = 0.5f;

// Starts as good as this are measured at once.
constexpr float kNear = 0.5f;
// Starts as good as this take one step.
constexpr float kOneStep = 0.1f;

// Where the search starts, of `levels` that there are: as asked, or on the finest level on which three deviations of the
// start are within reach, a pixel and a half.
int first_level(const PatchOptions& o, int levels) {
  if (o.first_level >= 0) return o.first_level < levels ? o.first_level : levels - 1;
  if (!(o.start_sd_px > 0)) return levels - 1;
  int l = 0;
  while (l + 1 < levels && o.start_sd_px > kNear * static_cast<float>(1 << l)) ++l;
  return l;
}

float level_scale(int level) {
  return 1.0f / static_cast<float>(1 << level);
}

}  // namespace

namespace patch {

namespace {

std::int16_t* take_cleared(Arena& arena, int elements) {
  const auto n = static_cast<std::size_t>(elements);
  auto* array = arena.take<std::int16_t>(n);
  if (array != nullptr) std::memset(array, 0, n * sizeof(std::int16_t));
  return array;
}

}  // namespace

Template take_template(Arena& arena, int window) {
  const auto cleared = [&] { return take_cleared(arena, padded(window)); };
  return {cleared(), cleared(), cleared(), cleared()};
}

void Work::lay_out(Arena& arena, int window_side) {
  window = window_side;
  count = padded(window);
  const auto cleared = [&](int elements) { return take_cleared(arena, elements); };
  own = plain = take_template(arena, window);
  x = cleared(count);
  y = cleared(count);
  for (auto& array : stretch) array = cleared(count);
  for (auto& array : masked) array = cleared(count);
  unclipped = cleared(count);
  image = cleared(count);
  all = cleared(count);
  part = cleared(count);
  block = cleared(block_size(window));
  scratch = cleared(scratch_size(window));
  bytes = arena.take<std::uint8_t>(static_cast<std::size_t>(block_size(window)));
  own_whole = whole = take_system(arena);
  partial = take_system(arena);
  is_prepared = false;
  if (all == nullptr) return;
  for (int k = 0; k < window * window; ++k) {
    all[k] = 1;
    x[k] = static_cast<std::int16_t>(k % window - window / 2);
    y[k] = static_cast<std::int16_t>(k / window - window / 2);
  }
}

}  // namespace patch

// Where a template comes from: around x in a pyramid, or from a slot, perhaps warped.
struct PatchTracker::Source {
  const Pyramid* pyramid;  // null: the slot
  Vec2 x;
  int slot;
  Mat2 warp, to_anchor;
  float strain_px;  // how far the warp moves the edge of the window
};

namespace {

Mat2 less_identity(const Mat2& m) {
  return {m.a - 1, m.b, m.c, m.d - 1};
}

// How far W moves the edge of a window, px.
float strain_of(const Mat2& w, int window) {
  const float change = max(max(magnitude(w.a - 1), magnitude(w.d - 1)), max(magnitude(w.b), magnitude(w.c)));
  return change * static_cast<float>(window / 2);
}

// Whether what is kept serves a search under this warp.
bool serves(const Kept& kept, const Mat2& warp, const PatchOptions& o, int window, float allowed_px) {
  return kept.is_made && kept.warp_sd == o.warp_sd && kept.min_eigenvalue == o.min_eigenvalue &&
         kept.takes_edges == o.takes_edges && kept.masks_clipped == o.masks_clipped &&
         strain_of(warp * inverse(kept.warp), window) <= allowed_px;
}

}  // namespace

Status PatchTracker::create(Arena& arena, const PatchLimits& limits) {
  return is_valid(limits) ? create_in(arena, *this, limits) : Status::bad_argument;
}

void PatchTracker::lay_out(Arena& arena, const PatchLimits& limits) {
  limits_ = limits;
  const auto slots = static_cast<std::size_t>(limits.slots);
  const auto squares = slots * static_cast<std::size_t>(limits.levels);
  anchors_ = arena.take<Anchor>(slots);
  surrounds_ = arena.take<Surround>(squares);
  pixels_ = arena.take<std::uint8_t>(squares * square_bytes(limits) + kReadAhead);
  kept_ = limits.keeps_templates ? arena.take<Kept>(slots) : nullptr;
  Kept measured_kept;
  for (std::size_t s = 0; limits.keeps_templates && s < slots; ++s) {
    Kept& kept = kept_ != nullptr ? kept_[s] : measured_kept;
    kept = {};
    kept.images = patch::take_template(arena, limits.window);
    kept.whole = patch::take_system(arena);
  }
  work_ = arena.take<Work>(1);
  Work measured;
  Work& work = work_ != nullptr ? *work_ : measured;
  work.lay_out(arena, limits.window);
  if (work_ == nullptr) return;
  std::memset(pixels_, 0, squares * square_bytes(limits) + kReadAhead);
  for (std::size_t s = 0; s < slots; ++s) anchors_[s] = {{}, 0};
}

PatchStatus PatchTracker::capture(int slot, const Pyramid& pyramid, Vec2 x, const PatchOptions& options) {
  if (!is_slot(slot) || pyramid.levels() == 0 || !is_finite(x)) return PatchStatus::bad_argument;
  const ImageView& full = pyramid.level(0);
  if (!contains(full, x, limits_.window / 2)) return PatchStatus::outside_image;
  const Source here{&pyramid, x, -1, {}, {}, 0};
  load_template(here, 0, options);
  if (!patch::has_texture(*work_, {options.min_eigenvalue, options.takes_edges})) return PatchStatus::flat;
  const int levels = limits_.levels < pyramid.levels() ? limits_.levels : pyramid.levels();
  for (int l = 0; l < levels; ++l) {
    const auto square = static_cast<std::size_t>(slot * limits_.levels + l);
    patch::store_surround(pyramid.level(l), level_scale(l) * x, patch::surround_side(limits_),
                          surrounds_[square], pixels_ + square * square_bytes(limits_));
  }
  anchors_[slot] = {x, levels};
  if (kept_ != nullptr) kept_[slot].is_made = false;
  return PatchStatus::ok;
}

void PatchTracker::release(int slot) {
  if (is_slot(slot)) anchors_[slot].levels = 0;
}

bool PatchTracker::is_captured(int slot) const {
  return is_slot(slot) && anchors_[slot].levels > 0;
}

Vec2 PatchTracker::anchor(int slot) const {
  return is_captured(slot) ? anchors_[slot].x : Vec2{};
}

// Makes the template of one level; gives the vector from its centre to the point, in current pixels of that
// level.
Vec2 PatchTracker::load_template(const Source& source, int level, const PatchOptions& options) {
  const patch::GreyRange range = patch::usable_range(options.masks_clipped);
  Work& work = *work_;
  work.plain = work.own;
  work.whole = work.own_whole;
  work.is_prepared = false;
  work.warp_left = {0, 0, 0, 0};
  if (source.pyramid != nullptr) {
    const Vec2 p = level_scale(level) * source.x;
    const int cx = static_cast<int>(p.x + 0.5f), cy = static_cast<int>(p.y + 0.5f);
    const int radius = limits_.window / 2;
    patch::load_template(source.pyramid->level(level), cx - radius, cy - radius, range, work);
    return {p.x - static_cast<float>(cx), p.y - static_cast<float>(cy)};
  }
  const auto square = static_cast<std::size_t>(source.slot * limits_.levels + level);
  const Vec2 offset = source.warp * surrounds_[square].offset;
  // A small warp is cheaper, and better, left to the last steps than resampled into the template.
  const float allowed_px = level > 0             ? kNegligibleCoarse
                           : options.warp_sd > 0 ? kLeftToLastSteps
                                                 : kNegligible;
  const bool is_warped = source.strain_px > allowed_px;
  if (!is_warped) work.warp_left = less_identity(source.to_anchor);
  if (kept_ != nullptr && level == 0) {
    Kept& kept = kept_[source.slot];
    work.plain = kept.images;
    work.whole = kept.whole;
    work.is_prepared = serves(kept, source.warp, options, limits_.window, allowed_px);
    if (work.is_prepared) work.warp_left = less_identity(kept.warp * source.to_anchor);
    if (work.is_prepared) return offset;
    kept.warp = is_warped ? source.warp : Mat2{};
    kept.warp_sd = options.warp_sd;
    kept.min_eigenvalue = options.min_eigenvalue;
    kept.takes_edges = options.takes_edges;
    kept.masks_clipped = options.masks_clipped;
    kept.is_made = false;  // nor is it before its equations are
  }
  patch::load_template(surrounds_[square], pixels_ + square * square_bytes(limits_),
                       patch::surround_side(limits_), is_warped ? &source.to_anchor : nullptr, range, work);
  return offset;
}

// The finest level: measured straight away where the start is good enough for that; where it is not, or that leads too
// far, found first.
PatchStatus PatchTracker::measure(const ImageView& image, patch::SearchOptions so, bool is_near,
                                  const PatchOptions& o, patch::Position& p, patch::Measurement& measured) {
  const Vec2 start = p.y;
  PatchStatus status = PatchStatus::diverged;
  int iterations = 0;
  for (int attempt = is_near ? 0 : 1; attempt < 2 && status == PatchStatus::diverged; ++attempt) {
    p = {start, 0, {}};
    status = PatchStatus::ok;
    so.epsilon_px = kCoarseStep * o.epsilon_px;
    if (attempt == 1) {
      so.starts_cheaply = false;
      status = patch::align(image, so, *work_, p);
    }
    so.epsilon_px = o.epsilon_px;
    if (status == PatchStatus::ok) status = patch::refine(image, so, o.warp_sd, *work_, p, measured);
    iterations += p.iterations;
  }
  p.iterations = iterations;
  return status;
}

PatchResult PatchTracker::search(const Source& source, const Pyramid& current, Vec2 start,
                                 const PatchOptions& o) {
  PatchResult result;
  result.x = start;
  const int there = source.pyramid != nullptr ? source.pyramid->levels() : anchors_[source.slot].levels;
  const int top = first_level(o, there < current.levels() ? there : current.levels());
  if (!is_finite(start) || top < 0 || o.max_iterations < 1) return result;
  result.status = PatchStatus::outside_image;
  if (!contains(current.level(0), start, 0)) return result;
  patch::SearchOptions so{o.max_iterations,
                          kCoarseStep * o.epsilon_px,
                          {o.min_eigenvalue, o.takes_edges},
                          patch::usable_range(o.masks_clipped),
                          false,
                          true};
  Vec2 x = start, along;
  patch::Measurement measured;
  bool is_near = o.start_sd_px > 0 && o.start_sd_px <= kNear;
  so.starts_cheaply = o.start_sd_px > kOneStep;
  for (int l = top; l >= 0; --l) {
    const Vec2 offset = load_template(source, l, o);
    patch::Position p{level_scale(l) * x - offset, 0, {}};
    so.needs_whole_window = l == 0;
    result.status = l == 0 ? measure(current.level(0), so, is_near, o, p, measured)
                           : patch::align(current.level(l), so, *work_, p);
    if (l == 0 && kept_ != nullptr && source.pyramid == nullptr)
      kept_[source.slot].is_made = work_->is_prepared;
    result.iterations += p.iterations;
    along = p.along;
    // A level that shows nothing is passed over; the finest decides.
    if (result.status != PatchStatus::ok) continue;
    x = static_cast<float>(1 << l) * (p.y + offset);
    is_near = true;
    so.starts_cheaply = false;
  }
  if (result.status != PatchStatus::ok) return result;
  result.x = x;
  patch::describe(measured, along, o, result);
  result.status = patch::judge(result, start, o);
  if (result.status != PatchStatus::ok) result.x = start;
  return result;
}

PatchResult PatchTracker::track(int slot, const Pyramid& current, Vec2 start, const Mat2& warp,
                                const PatchOptions& options) {
  PatchResult failure;
  failure.x = start;
  if (!is_slot(slot) || !is_plausible(warp)) return failure;
  failure.status = PatchStatus::empty_slot;
  if (!is_captured(slot)) return failure;
  const Source source{nullptr, {}, slot, warp, inverse(warp), strain_of(warp, limits_.window)};
  return search(source, current, start, options);
}

PatchResult PatchTracker::track_between(const Pyramid& previous, Vec2 x, const Pyramid& current, Vec2 start,
                                        const PatchOptions& options) {
  PatchResult failure;
  failure.x = start;
  if (work_ == nullptr || previous.levels() == 0 || !is_finite(x)) return failure;
  failure.status = PatchStatus::outside_image;
  if (!contains(previous.level(0), x, limits_.window / 2)) return failure;
  const Source forward{&previous, x, -1, {}, {}, 0};
  PatchResult result = search(forward, current, start, options);
  if (result.status != PatchStatus::ok || !(options.max_return_px > 0)) return result;
  if (!contains(current.level(0), result.x, limits_.window / 2)) {
    result.status = PatchStatus::outside_image;
    return result;
  }
  const Source backward{&current, result.x, -1, {}, {}, 0};
  const PatchResult back = search(backward, previous, result.x - (start - x), options);
  result.iterations += back.iterations;
  result.return_px = patch::distance_seen(back.x - x, result);
  if (back.status != PatchStatus::ok || result.return_px > options.max_return_px)
    result.status = PatchStatus::inconsistent;
  return result;
}

}  // namespace pliant
