// Where the tracked points are in this frame: by their templates, and failing that from the frame before.
#include "track/edge_search.hpp"
#include "track/tracker_sizes.hpp"

namespace pliant {

namespace {

constexpr std::uint8_t kMostFramesApart = 20;
/// Of what the model could not explain of a point in the last frame, the share by which it is searched for elsewhere: as
/// much as stays, and less than would let a point that slips go on slipping.
constexpr float kRemembered = 0.7f;
constexpr float kFollowedShare = 0.25f;  // weight of a patch that was only followed from the frame before

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

/// Largest entry of W - I, W the warp from `reference` to `now`.
float strain(const Mat2& now, const Mat2& reference) {
  const Mat2 w = now * inverse(reference);
  return max(max(magnitude(w.a - 1), magnitude(w.d - 1)), max(magnitude(w.b), magnitude(w.c)));
}

}  // namespace

bool Tracker::is_in_region(Vec2 x) const {
  const Vec2 at = x - origin_;
  return at.x >= 0 && at.y >= 0 && at.x <= static_cast<float>(region_width(limits_) - 1) &&
         at.y <= static_cast<float>(region_height(limits_) - 1);
}

/// Scouts: some of the points, spread over the surface and others in each frame, are looked at ahead of the rest, which
/// are then looked for much nearer to where they are. \return false where there are too few points for that, or the scouts
/// leave doubt, or do not pay: where the model leaves as much of a face unexplained as it moves, they bring nobody nearer.
bool Tracker::look_ahead() {
  constexpr std::size_t kFirstPassPoints = 40, kLeastShare = 3;
  constexpr float kLeastGain = 1.5f;
  constexpr std::uint32_t kTryAgain = 16;  // frames
  std::size_t seen = 0, n = 0;
  for (std::size_t k = 0; k < slot_count_; ++k) {
    Slot& slot = slots_[k];
    slot.is_awaited = true;
    slot.is_first_pass = false;
    seen += slot.is_used && slot.owner == k && slot.was_seen;
  }
  const std::size_t share = seen / kFirstPassPoints;
  if (share < kLeastShare || bad_frames_ > 0 || options_.rounds < 2) return false;
  if (moved_px_ < kLeastGain * left_px_ && left_px_ < 1e9f && frame_ % kTryAgain != 0) return false;
  std::size_t candidate = frame_ % share;
  for (std::size_t k = 0; k < slot_count_; ++k) {
    Slot& slot = slots_[k];
    if (!slot.is_used || slot.owner != k) continue;
    slot.observation = static_cast<std::uint16_t>(n++);
    observations_[slot.observation] = {};
    observations_[slot.observation].id = slot.id;
    observations_[slot.observation].reason = Reason::not_visible;
    slot.is_first_pass = slot.was_seen && candidate++ % share == 0;
    if (slot.is_first_pass) look_at(k, estimator_.predict(slot.id), 0);
  }
  return estimator_.solve_first_pass({observations_, n});
}

/// The finest pyramid level from which the search reaches as far as the prediction is likely to be off.
int Tracker::first_level() const {
  const float off = 2 * moved_px_ + 0.1f * shift_px_;
  return off < 2 ? 0 : off < 4 ? 1 : -1;
}

/// Whether another look can see more of a point than the last one did: it was not found, or is not where it is now
/// expected, or would be compared with a template that is warped in another way.
Tracker::Look Tracker::needed_look(const Slot& slot, const Prediction& p, int round) const {
  if (slot.is_awaited) return Look::full;
  if (round == 0) return Look::none;
  const Observation& o = observations_[slot.observation];
  if (!p.visible) return o.reason == Reason::not_visible ? Look::none : Look::full;
  const float edge_px = strain(p.jacobian, slot.looked_with) * static_cast<float>(limits_.patch_window / 2);
  if (edge_px > 0.3f) return Look::full;
  if (o.reason != Reason::found && o.reason != Reason::rejected)
    return length(p.x - slot.looked_at) > 1 ? Look::full : Look::follow_only;
  const bool is_elsewhere = length(o.x - p.x) > scaled_px(limits_, 3);
  return is_elsewhere || o.score < options_.min_correlation ? Look::full : Look::none;
}

/// \return how many points were looked at.
std::size_t Tracker::look_and_solve(int round) {
  const Span<const Prediction> predictions = estimator_.predict();
  for (std::size_t i = 0; i < predictions.count; ++i)
    prediction_of_[predictions[i].id] = static_cast<std::uint16_t>(i);
  std::size_t n = 0, looks = 0;
  for (std::size_t k = 0; k < slot_count_; ++k) {
    Slot& slot = slots_[k];
    if (!slot.is_used || slot.owner != k) continue;
    const Prediction& p = predictions[prediction_of_[slot.id]];
    slot.observation = static_cast<std::uint16_t>(n++);
    const Look needed = needed_look(slot, p, round);
    if (needed == Look::none) continue;
    if (needed == Look::full) look_at(k, p, round);
    if (needed == Look::follow_only) observations_[slot.observation] = follow(k, p);
    ++looks;
  }
  point_observation_count_ = n;
  if (round + 1 == options_.rounds && options_.estimator.uses(Cue::edge)) {
    constexpr float kAfterPatches =
        1.5f;  // px at 320 of width: how far off curves are when patches, or scouts, have been heard
    const std::size_t room = EdgeSearch::kAlternatives * edge_points(limits_);
    n += edges_->look(predictions, prediction_of_, current_, origin_, estimator_.view().s,
                      scaled_px(limits_, kAfterPatches), {observations_ + n, room});
    looks += n - point_observation_count_;
  }
  observation_count_ = n;
  if (looks > 0) estimator_.solve({observations_, n});
  return looks;
}

void Tracker::look_at(std::size_t k, const Prediction& p, int round) {
  Slot& slot = slots_[k];
  if (slot.is_awaited) slot.expected = p.x + kRemembered * slot.residual;
  observations_[slot.observation] = look(k, p, round);
  slot.looked_at = p.x;
  slot.looked_with = p.jacobian;
  slot.is_awaited = false;
}

/// Searches from where the model expects the point, about as far off as it was last time.
PatchResult Tracker::match(std::size_t k, const Prediction& p, int round) {
  PatchOptions options;
  const bool last = round + 1 == options_.rounds;
  options.min_correlation = last ? options_.min_correlation : options_.min_correlation - 0.1f;
  const Slot& slot = slots_[k];
  const bool is_first = slot.is_awaited, after_first_pass = is_first && round > 0;
  // Where a point is that was not seen in the last frame, neither that frame nor scouts can tell.
  const bool is_known = slot.was_seen || !is_first;
  options.first_level = !is_known || after_first_pass ? -1 : round == 0 ? first_level() : 0;
  // Along either axis.
  options.start_sd_px = is_known ? 0.7f * (after_first_pass ? left_px_ : moved_px_) : 0;
  options.max_move_px = scaled_px(limits_, is_first ? 16.0f : 3.0f);
  std::size_t which = k;
  if (slot.second != kNoSlot &&
      strain(p.jacobian, slots_[slot.second].reference) < strain(p.jacobian, slot.reference))
    which = slot.second;
  return patches_.track(static_cast<int>(which), current_, p.x + kRemembered * slot.residual - origin_,
                        p.jacobian * inverse(slots_[which].reference), options);
}

Observation Tracker::look(std::size_t k, const Prediction& p, int round) {
  Observation o;
  o.id = p.id;
  o.reason = Reason::not_visible;
  if (!p.visible || !is_in_region(p.x)) return o;
  const PatchResult found = match(k, p, round);
  o.reason = reason_of(found.status);
  if (found.status != PatchStatus::ok) return round + 1 == options_.rounds ? follow(k, p) : o;
  o.x = found.x + origin_;
  o.information = found.information;
  o.score = found.correlation;
  return o;
}

/// From the frame before, when the patch no longer looks as it did (a mouth that opens, a highlight).
Observation Tracker::follow(std::size_t k, const Prediction& p) {
  const Slot& slot = slots_[k];
  Observation o;
  o.id = p.id;
  o.reason = Reason::low_correlation;
  const bool is_wanted = limits_.keeps_previous && options_.estimator.uses(Cue::flow);
  if (!is_wanted || !slot.was_seen || slot.frames_apart >= kMostFramesApart) return o;
  PatchOptions options;
  options.max_return_px = scaled_px(limits_, options_.forward_backward_px);
  const PatchResult found =
      patches_.track_between(previous_, slot.seen - previous_origin_, current_, p.x - origin_, options);
  o.reason = reason_of(found.status);
  if (found.status != PatchStatus::ok) return o;
  o.x = found.x + origin_;
  o.information = {kFollowedShare * found.information.xx, kFollowedShare * found.information.xy,
                   kFollowedShare * found.information.yy};
  o.cue = Cue::flow;
  o.score = found.correlation;
  return o;
}

void Tracker::note_seen() {
  const bool good = result_.state == TrackState::tracking;
  float sum[2] = {}, count[2] = {};  // scouts, or all where there are none; others
  for (std::size_t k = 0; k < slot_count_; ++k) {
    Slot& slot = slots_[k];
    if (!slot.is_used || slot.owner != k) continue;
    const Observation& o = observations_[slot.observation];
    slot.was_seen = good && o.reason == Reason::found;
    slot.residual = slot.was_seen ? o.residual : Vec2{};
    if (!slot.was_seen) continue;
    slot.seen = o.x;
    const Vec2 off = o.x - slot.expected;
    const bool after_first_pass = has_first_pass_ && !slot.is_first_pass;
    sum[after_first_pass] += dot(off, off);
    ++count[after_first_pass];
    if (o.cue == Cue::patch)
      slot.frames_apart = 0;
    else if (slot.frames_apart < kMostFramesApart)
      ++slot.frames_apart;
  }
  if (good)
    edges_->note({observations_ + point_observation_count_, observation_count_ - point_observation_count_});
  moved_px_ = good && count[0] > 0 ? square_root(sum[0] / count[0]) : 1e9f;
  if (has_first_pass_ || !good) left_px_ = good && count[1] > 0 ? square_root(sum[1] / count[1]) : 1e9f;
}

}  // namespace pliant
