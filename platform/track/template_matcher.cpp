// Template matching of a frame (docs/algorithms.md, sections 7.3 and 7.5).
#include "track/template_matcher.hpp"

#include "track/template_tuning.hpp"
#include "track/tracker_sizes.hpp"

namespace pliant {

namespace {

constexpr const TemplateMatchTuning& kTuning = kTemplateMatchTuning;
/// One axis of an isotropic distance has 1 / sqrt(2) of its root mean square.
constexpr float kPerAxis = 0.7f;

bool is_last(int round) {
  return round + 1 == kTuning.rounds;
}

Reason reason_of(PatchStatus status) {
  switch (status) {
    case PatchStatus::ok:
      return Reason::found;
    case PatchStatus::outside_image:
      return Reason::outside_image;
    case PatchStatus::flat:
    case PatchStatus::empty_slot:
      return Reason::no_texture;
    case PatchStatus::low_correlation:
    case PatchStatus::bad_light:
      return Reason::low_correlation;
    case PatchStatus::inconsistent:
      return Reason::forward_backward;
    case PatchStatus::bad_argument:
    case PatchStatus::diverged:
      break;
  }
  return Reason::diverged;
}

Observation not_found(std::uint16_t id, Reason reason) {
  Observation o;
  o.id = id;
  o.reason = reason;
  return o;
}

}  // namespace

void TemplateMatcher::lay_out(Arena& arena, const TrackerLimits& limits) {
  capacity_ = all_slots(limits);
  frame_width_ = limits.width;
  half_window_ = static_cast<float>(limits.patch_window / 2);
  arena.count_as(Purpose::points);
  searches_ = arena.take<Search>(capacity_);
}

void TemplateMatcher::start(bool uses_frame_to_frame) {
  uses_frame_to_frame_ = uses_frame_to_frame;
  count_ = 0;
  innovation_px_ = later_innovation_px_ = coarse_px_ = kUnknownPx;
}

void TemplateMatcher::begin_frame(std::uint32_t frame, bool is_trusted, float coarse_px, SearchFrom from) {
  frame_ = frame;
  is_aligned_ = from == SearchFrom::alignment;
  is_trusted_ = is_trusted;
  coarse_px_ = coarse_px;
  had_first_pass_ = false;
  work_ = {};
  for (std::size_t k = 0; k < capacity_; ++k) searches_[k].is_pending = true;
}

/// \param ratio  points found in the last frame, for each in the first pass.
bool TemplateMatcher::should_run_first_pass(std::size_t ratio) const {
  if (ratio < kTuning.first_pass_least_ratio || !is_trusted_ || kTuning.rounds < 2) return false;
  const bool pays = innovation_px_ >= kTuning.first_pass_least_gain * later_innovation_px_;
  return pays || !(later_innovation_px_ < kUnknownPx) || frame_ % kTuning.first_pass_retry_frames == 0;
}

bool TemplateMatcher::run_first_pass(const MatchFrame& frame, Estimator& estimator) {
  const TemplateStore& templates = frame.templates;
  std::size_t found = 0, n = 0;
  for (std::size_t k = 0; k < capacity_; ++k) found += templates.is_first(k) && templates[k].was_found;
  const std::size_t ratio = found / kTuning.first_pass_points;
  if (!should_run_first_pass(ratio)) return false;
  std::size_t candidate = frame_ % ratio;
  for (std::size_t k = 0; k < capacity_; ++k) {
    if (!templates.is_first(k)) continue;
    Search& search = searches_[k];
    search.observation = static_cast<std::uint16_t>(n++);
    frame.observations[search.observation] = not_found(templates[k].id, Reason::not_visible);
    search.is_first_pass =
        templates[k].was_found && candidate++ % ratio == 0 && work_.search_steps < most_steps_;
    if (search.is_first_pass) search_for(frame, k, estimator.predict(templates[k].id), 0);
  }
  had_first_pass_ = estimator.solve_first_pass({frame.observations.data, n});
  return had_first_pass_;
}

std::size_t TemplateMatcher::match(const MatchFrame& frame, const PredictionTable& predictions, int round) {
  PLIANT_ASSERT(frame.observations.count >= capacity_);
  std::size_t n = 0, searched = 0;
  for (std::size_t k = 0; k < capacity_; ++k) {
    if (!frame.templates.is_first(k)) continue;
    Search& search = searches_[k];
    const Prediction& p = predictions[frame.templates[k].id];
    search.observation = static_cast<std::uint16_t>(n++);
    Observation& o = frame.observations[search.observation];
    const bool has_work_left = work_.search_steps < most_steps_;
    if (!has_work_left && search.is_pending) o = not_found(p.id, Reason::not_visible);
    const Action next = has_work_left ? action(search, o, p, round) : Action::none;
    if (next == Action::search) search_for(frame, k, p, round);
    if (next == Action::track_from_previous) o = track_from_previous(frame, k, p);
    searched += next != Action::none;
  }
  count_ = n;
  return searched;
}

/// Decides whether to search again. A new search is useful if the point was not found, if it was found away from the new
/// prediction, or if the warp of its template has changed.
TemplateMatcher::Action TemplateMatcher::action(const Search& search, const Observation& last,
                                                const Prediction& p, int round) const {
  if (search.is_pending) return Action::search;
  if (round == 0) return Action::none;  // searched for by a first pass that failed: the prediction is still the same
  if (!p.visible) return last.reason == Reason::not_visible ? Action::none : Action::search;
  if (strain(p.jacobian, search.jacobian) * half_window_ > kTuning.rematch_warp_px) return Action::search;
  const bool was_found = last.reason == Reason::found || last.reason == Reason::rejected;
  if (!was_found)
    return length(p.x - search.prediction) > kTuning.rematch_move_px ? Action::search
                                                                     : Action::track_from_previous;
  const bool is_elsewhere = length(last.x - p.x) > scaled_px(frame_width_, kTuning.rematch_distance_px);
  return is_elsewhere || last.score < kTuning.min_correlation ? Action::search : Action::none;
}

void TemplateMatcher::search_for(const MatchFrame& frame, std::size_t k, const Prediction& p, int round) {
  Search& search = searches_[k];
  if (search.is_pending) search.expected = p.x + kTuning.residual_memory * frame.templates[k].residual;
  frame.observations[search.observation] = this->search(frame, k, p, round);
  search.prediction = p.x;
  search.jacobian = p.jacobian;
  search.is_pending = false;
}

Observation TemplateMatcher::search(const MatchFrame& frame, std::size_t k, const Prediction& p, int round) {
  if (!p.visible || !frame.region.contains(p.x)) return not_found(p.id, Reason::not_visible);
  const Template& point = frame.templates[k];
  const PatchResult result =
      frame.templates.match(k, frame.region, p.x + kTuning.residual_memory * point.residual, p.jacobian,
                            frame.depths, search_options(point, searches_[k].is_pending, round));
  count(result, 1);
  Observation o = not_found(p.id, reason_of(result.status));
  if (result.status != PatchStatus::ok) return is_last(round) ? track_from_previous(frame, k, p) : o;
  o.x = result.x + frame.region.origin();
  o.information = result.information;
  o.score = result.correlation;
  return o;
}

void TemplateMatcher::count(const PatchResult& result, std::uint32_t searches) {
  work_.searches += searches;
  work_.search_steps += static_cast<std::uint32_t>(result.iterations) + searches * kTuning.preparation_steps;
}

/// The search reaches about as far as points were from their predictions in the last frame.
PatchOptions TemplateMatcher::search_options(const Template& point, bool is_pending, int round) const {
  PatchOptions options;
  options.min_correlation =
      is_last(round) ? kTuning.min_correlation : kTuning.min_correlation - kTuning.early_correlation_slack;
  const bool is_after_first_pass = is_pending && round > 0;
  // The position of a point that was not found in the last frame is not known before the first pass.
  const bool is_known = point.was_found || !is_pending;
  options.first_level = is_aligned_                        ? 0
                        : !is_known || is_after_first_pass ? -1
                        : round == 0                       ? first_level()
                                                           : 0;
  options.start_sd_px =
      is_known ? kPerAxis * (is_after_first_pass ? later_innovation_px_ : innovation_px_) : 0;
  options.max_move_px = scaled_px(frame_width_, is_pending ? kTuning.first_reach_px : kTuning.later_reach_px);
  return options;
}

/// The finest pyramid level from which a search reaches as far as predictions are likely to be off. The coarsest one is given by
/// its number, since -1 leaves the choice to start_sd_px, of which the coarse translation is no part.
int TemplateMatcher::first_level() const {
  const float off = kTuning.reach_per_innovation * innovation_px_ + kTuning.reach_per_coarse_px * coarse_px_;
  return off < kTuning.level_0_reach_px ? 0 : off < kTuning.level_1_reach_px ? 1 : Pyramid::kMaxLevels - 1;
}

/// For a template that no longer matches: a mouth that opens, a highlight (docs/algorithms.md, section 7.5).
Observation TemplateMatcher::track_from_previous(const MatchFrame& frame, std::size_t k,
                                                 const Prediction& p) {
  const Template& point = frame.templates[k];
  if (!uses_frame_to_frame_ || !point.was_found || point.frames_apart >= kTuning.frame_to_frame_most)
    return not_found(p.id, Reason::low_correlation);
  PatchOptions options;
  options.max_return_px = scaled_px(frame_width_, kTuning.forward_backward_px);
  const PatchResult result = frame.templates.match_from_previous(point.found_at, frame.region, p.x, options);
  const bool has_returned = result.status == PatchStatus::ok || result.status == PatchStatus::inconsistent;
  count(result, has_returned ? 2 : 1);
  Observation o = not_found(p.id, reason_of(result.status));
  if (result.status != PatchStatus::ok) return o;
  o.x = result.x + frame.region.origin();
  o.information = {kTuning.frame_to_frame_weight * result.information.xx,
                   kTuning.frame_to_frame_weight * result.information.xy,
                   kTuning.frame_to_frame_weight * result.information.yy};
  o.cue = Cue::flow;
  o.score = result.correlation;
  return o;
}

void TemplateMatcher::end_frame(const MatchFrame& frame, bool is_good) {
  float sum[2] = {}, count[2] = {};  // points searched for first; those after a first pass
  for (std::size_t k = 0; k < capacity_; ++k) {
    if (!frame.templates.is_first(k)) continue;
    Template& point = frame.templates[k];
    const Search& search = searches_[k];
    const Observation& o = frame.observations[search.observation];
    point.was_found = is_good && o.reason == Reason::found;
    point.residual = point.was_found ? o.residual : Vec2{};
    if (!point.was_found) continue;
    point.found_at = o.x;
    point.correlation = o.score;
    const Vec2 off = o.x - search.expected;
    const bool is_later = had_first_pass_ && !search.is_first_pass;
    sum[is_later] += dot(off, off);
    ++count[is_later];
    if (o.cue == Cue::patch)
      point.frames_apart = 0;
    else if (point.frames_apart < kTuning.frame_to_frame_most)
      ++point.frames_apart;
  }
  const auto rms = [&](int k) {
    return is_good && count[k] > 0 ? square_root(sum[k] / count[k]) : kUnknownPx;
  };
  innovation_px_ = rms(0);
  if (had_first_pass_ || !is_good) later_innovation_px_ = rms(1);
}

}  // namespace pliant
