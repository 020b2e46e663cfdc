#include "vision/patch_search.hpp"

#include "base/integers.hpp"
#include "vision/patch_result.hpp"
#include "vision/patch_tuning.hpp"
#include "vision/strain.hpp"

namespace pliant::patch {
namespace {

Mat2 less_identity(const Mat2& m) {
  return {m.a - 1, m.b, m.c, m.d - 1};
}

// How far W moves the edge of a window, px.
float window_strain_px(const Mat2& w, int window) {
  return strain(w) * static_cast<float>(window / 2);
}

float level_scale(int level) {
  return 1.0f / static_cast<float>(1 << level);
}

// The level that the search starts on, of `levels`: as asked, or the finest on which three deviations of the start
// are within reach, 1.5 px.
int first_level(const PatchOptions& o, int levels) {
  if (o.first_level >= 0) return smaller(o.first_level, levels - 1);
  if (!(o.start_sd_px > 0)) return levels - 1;
  int l = 0;
  while (l + 1 < levels && o.start_sd_px > kPatchTuning.near_start_px * static_cast<float>(1 << l)) ++l;
  return l;
}

// Whether equations that allow for one ramp serve for another one.
bool are_alike(float ramp_sd, float other) {
  return min(ramp_sd, other) >= kPatchTuning.least_ramp_ratio * max(ramp_sd, other);
}

// Puts the slot's cached template into use. \return whether it serves this warp; otherwise it has to be made.
bool use_cached(CachedTemplate& cached, const TemplateSource& source, bool is_warped, bool accepts_edges,
                Workspace& work) {
  work.active = cached.images;
  work.system = cached.system;
  work.has_system =
      cached.is_made && cached.accepts_edges == accepts_edges && are_alike(cached.ramp_sd, work.ramp_sd) &&
      window_strain_px(source.warp * inverse(cached.warp), work.window) <= kPatchTuning.unwarped_strain_px;
  if (work.has_system) {
    work.residual_warp = less_identity(cached.warp * source.to_template);
    return true;
  }
  cached.warp = is_warped ? source.warp : Mat2{};
  cached.ramp_sd = work.ramp_sd;
  cached.accepts_edges = accepts_edges;
  cached.is_made = false;  // until its equations are
  return false;
}

// The finest level. A near start is refined at once; if that diverges, or the start is not near, it is aligned first.
PatchStatus search_finest(const ImageView& image, SearchOptions options, bool is_near, Workspace& work,
                          SearchPosition& p, Measurement& measured) {
  const Vec2 start = p.x;
  PatchStatus status = PatchStatus::diverged;
  if (is_near) status = refine(image, options, work, p, measured);
  if (status != PatchStatus::diverged) return status;
  const int iterations = p.iterations;
  p = {start, 0, {}};
  options.is_far = false;
  status = align(image, options, work, p);
  if (status == PatchStatus::ok) status = refine(image, options, work, p, measured);
  p.iterations += iterations;
  return status;
}

}  // namespace

TemplateSource TemplateSource::of_slot(int slot, const Mat2& warp, int window) {
  return {nullptr, {}, slot, warp, inverse(warp), window_strain_px(warp, window)};
}

bool contains(const ImageView& image, Vec2 x, int margin) {
  const auto m = static_cast<float>(margin);
  return x.x >= m && x.y >= m && x.x <= static_cast<float>(image.width - 1) - m &&
         x.y <= static_cast<float>(image.height - 1) - m;
}

Vec2 load_level(SearchState& state, const TemplateSource& source, int level, bool accepts_edges) {
  Workspace& work = state.work;
  work.active = work.own_template;
  work.system = work.own_system;
  work.has_system = false;
  work.residual_warp = {0, 0, 0, 0};
  if (source.pyramid != nullptr) {
    const Vec2 p = level_scale(level) * source.x;
    const int cx = static_cast<int>(p.x + 0.5f), cy = static_cast<int>(p.y + 0.5f), radius = work.window / 2;
    load_template(source.pyramid->level(level), cx - radius, cy - radius, work);
    return {p.x - static_cast<float>(cx), p.y - static_cast<float>(cy)};
  }
  const StoredTemplate& stored = state.slots.stored(source.slot, level);
  const Vec2 offset = source.warp * stored.offset;
  const bool is_warped = source.strain_px > kPatchTuning.unwarped_strain_px;
  if (!is_warped) work.residual_warp = less_identity(source.to_template);
  CachedTemplate* const cached = level == 0 ? state.slots.cached(source.slot) : nullptr;
  if (cached != nullptr && use_cached(*cached, source, is_warped, accepts_edges, work)) return offset;
  load_template(stored, state.slots.pixels(source.slot, level), state.slots.side(),
                is_warped ? &source.to_template : nullptr, work);
  return offset;
}

PatchResult search(SearchState& state, const TemplateSource& source, const Pyramid& current, Vec2 start,
                   const PatchOptions& o) {
  PatchResult result;
  result.x = start;
  const int stored = source.pyramid != nullptr ? source.pyramid->levels() : state.slots.levels(source.slot);
  const int top = first_level(o, smaller(stored, current.levels()));
  if (!is_finite(start) || top < 0) return result;
  result.status = PatchStatus::outside_image;
  if (!contains(current.level(0), start, 0)) return result;
  const bool accepts_edges = o.normal_flow != nullptr;
  SearchOptions options{accepts_edges, false, o.start_sd_px > kPatchTuning.one_step_start_px};
  bool is_near = o.start_sd_px > 0 && o.start_sd_px <= kPatchTuning.near_start_px;
  Vec2 x = start, along;
  Measurement measured;
  state.work.ramp_sd = o.ramp_sd;
  for (int l = top; l >= 0; --l) {
    const Vec2 offset = load_level(state, source, l, accepts_edges);
    SearchPosition p{level_scale(l) * x - offset, 0, {}};
    options.needs_whole_window = l == 0;
    result.status = l == 0 ? search_finest(current.level(0), options, is_near, state.work, p, measured)
                           : align(current.level(l), options, state.work, p);
    if (l == 0 && source.pyramid == nullptr && state.slots.cached(source.slot) != nullptr)
      state.slots.cached(source.slot)->is_made = state.work.has_system;
    result.iterations += p.iterations;
    along = p.along;
    // A coarse level without texture is skipped; the finest level decides.
    if (result.status != PatchStatus::ok) continue;
    x = static_cast<float>(1 << l) * (p.x + offset);
    is_near = true;
    options.is_far = false;
  }
  if (result.status != PatchStatus::ok) return result;
  result.x = x;
  describe(measured, along, o.normal_flow, result);
  result.status = judge(result, start, o);
  if (result.status != PatchStatus::ok) result.x = start;
  return result;
}

}  // namespace pliant::patch
