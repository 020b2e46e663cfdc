#include "track/person_refinement.hpp"

#include "track/person_estimate.hpp"
#include "track/person_rows.hpp"
#include "track/surface_offset.hpp"
#include "track/tracker_parts.hpp"
#include "track/tracker_sizes.hpp"

namespace pliant {

/// In the arena.
struct PersonState {
  PersonRows rows;
  PersonEstimate estimate;
  std::uint8_t* is_free = nullptr;
  float *now = nullptr, *best = nullptr;    // rotation against the start, then identity
  float *start_q = nullptr, *sd = nullptr;  // identity: of the start; of the population
  bool is_active = false;
  std::uint32_t taken_frame = 0, step_frame = 0;  // the last one that was taken; the last with a step

  void lay_out(Arena& arena, const Model& model);
};

namespace {

constexpr const PersonRefinementTuning& kTuning = kPersonRefinementTuning;

std::size_t identities(const Model& model) {
  std::size_t n = 0;
  for (const Parameter& p : model.parameters()) n += p.group == Group::identity;
  return n;
}

/// Where everything is seen in its key frame before a step, so that it stays there.
struct Places {
  Vec2 *templates = nullptr, *landmarks = nullptr, *markers = nullptr;
  float* q = nullptr;

  void lay_out(Arena& arena, const Model& model, const TrackerLimits& limits) {
    templates = arena.take<Vec2>(all_slots(limits));
    landmarks = arena.take<Vec2>(model.landmarks().count);
    markers = arena.take<Vec2>(limits.markers);
    q = arena.take<float>(model.parameters().count);
  }
};

PersonState* lay_out(Arena& arena, const Model& model) {
  arena.count_as(Purpose::state);
  return identities(model) > 0 ? create_part<PersonState>(arena, model) : nullptr;
}

std::size_t scratch_bytes(const Model& model, const TrackerLimits& limits) {
  if (identities(model) == 0) return 0;
  Arena trial;
  PersonEquations equations;
  equations.lay_out(trial, kPoseUnknowns + 3 + model.parameters().count);
  Places places;
  places.lay_out(trial, model, limits);
  return trial.used_bytes() + PersonRows::scratch_bytes(model) + Arena::kAlignment;
}

void start(TrackerParts& t, const TrackerOptions& options) {
  PersonState& s = *t.person;
  const Span<const Parameter> all = t.model().parameters();
  s.is_active = !t.identity_is_given;
  for (std::size_t k = 0; k < all.count; ++k) {
    const bool is_identity = all[k].group == Group::identity;
    s.is_free[k] = options.is_free != nullptr ? options.is_free[k] : static_cast<std::uint8_t>(!is_identity);
    s.is_active = s.is_active && !(is_identity && s.is_free[k] != 0);
  }
  s.rows.start(t.model(), s.is_free);
  s.estimate.clear();
  s.taken_frame = s.step_frame = 0;
  for (std::size_t k = 0; k < 3; ++k) s.now[k] = 0;
  for (std::size_t k = 3; k < s.rows.kept(); ++k) {
    s.sd[k - 3] = kTuning.start_sd * all[s.rows.identity(k - 3)].sd;
    s.start_q[k - 3] = t.estimator.parameters()[s.rows.identity(k - 3)];
  }
}

/// Key frame of the first template of a point; null where it has none.
const View* key_of(const TrackerParts& t, std::uint16_t id) {
  for (std::size_t slot = 0; slot < t.templates.count(); ++slot) {
    if (!t.templates.is_first(slot) || t.templates[slot].id != id) continue;
    return t.key_frames.view_of(key_of_slot(t.limits, slot));
  }
  return nullptr;
}

/// Whether an observation says something of the person.
bool is_usable(const Observation& o) {
  return o.reason == Reason::found && o.cue != Cue::flow;
}

/// The equations of a frame; of many observations each second, third, ..., in turn from frame to frame.
void gather(TrackerParts& t, PersonEquations& equations, Arena& scratch) {
  PersonState& s = *t.person;
  equations.lay_out(scratch, s.rows.count());
  equations.reset();
  s.rows.begin(scratch, t.model(), t.estimator.view(), t.estimator.parameters().data);
  std::size_t usable = 0, seen = t.frame;
  for (std::size_t k = 0; k < t.observation_count; ++k) usable += is_usable(t.observations[k]);
  const std::size_t step = usable / kTuning.most_observations + 1;
  for (std::size_t k = 0; k < t.observation_count; ++k) {
    Observation o = t.observations[k];
    if (!is_usable(o) || seen++ % step != 0) continue;
    const View* const key = o.cue == Cue::patch ? key_of(t, o.id) : nullptr;
    if (o.cue == Cue::patch && key == nullptr) continue;
    o.x = t.estimator.lens().undistort(o.x);
    s.rows.add(o, t.estimator.point_uv(o.id), key, equations);
  }
  s.rows.add_priors(equations);
  equations.eliminate(s.rows.count() - s.rows.kept());
}

/// The step towards the best value: of the rotation and, in `q`, of the identity. \return false where it is too small.
bool choose_step(PersonState& s, const Model& model, float* q, Vec3* turn) {
  bool is_worth = false;
  float step[3];
  for (std::size_t k = 0; k < 3; ++k) {
    step[k] = kTuning.rate * (s.best[k] - s.now[k]);
    is_worth = is_worth || magnitude(step[k]) > kTuning.least_turn;
  }
  for (std::size_t k = 3; k < s.rows.kept(); ++k) {
    const Parameter& p = model.parameters()[s.rows.identity(k - 3)];
    const float to = clamp(s.now[k] + kTuning.rate * (s.best[k] - s.now[k]), p.minimum, p.maximum);
    is_worth = is_worth || magnitude(to - s.now[k]) > kTuning.least_step_sd * p.sd;
    q[s.rows.identity(k - 3)] = to;
  }
  *turn = {step[0], step[1], step[2]};
  return is_worth;
}

/// Calls visit(slot, view of its key frame) for the first template of each point.
template <class Visit>
void for_each_template(TrackerParts& t, Visit&& visit) {
  for (std::size_t key = 0; key <= t.limits.key_frames; ++key) {
    const View* const view = t.key_frames.view_of(key);
    if (view == nullptr) continue;
    for (std::size_t slot = first_slot(t.limits, key); slot < first_slot(t.limits, key + 1); ++slot)
      if (t.templates.is_first(slot)) visit(slot, *view);
  }
}

/// The (u,v) near `uv` that a view sees at x.
Vec2 back_to(Vec2 x, const View& view, Vec2 uv, Estimator& estimator) {
  const Projector projector(view, true);
  for (int k = 0; k < kTuning.slides; ++k) {
    const SurfaceFrame f = estimator.surface_frame(uv);
    Vec2 now;
    Projector::Derivatives d;
    if (!projector.project(f.p, &now, &d)) return uv;
    const Vec2 a = d.along(f.pu), b = d.along(f.pv), r = x - now;
    const float area = a.x * b.y - a.y * b.x;
    if (magnitude(area) < kPersonRowsTuning.least_area * (dot(a, a) + dot(b, b))) return uv;
    const auto limited = [](float step) { return clamp(step, -kTuning.most_slide, kTuning.most_slide); };
    uv = {clamp(uv.x + limited((r.x * b.y - r.y * b.x) / area), 0, 1),
          clamp(uv.y + limited((a.x * r.y - a.y * r.x) / area), 0, 1)};
  }
  return uv;
}

/// Changes the person. Every template, landmark and marker stays where its key frame showed it.
void take_step(TrackerParts& t, const Places& places, Vec3 by) {
  Estimator& e = t.estimator;
  for_each_template(t, [&](std::size_t slot, const View& view) {
    places.templates[slot] = kNowhere;
    Projector(view, true).project(e.surface_point(e.point_uv(t.templates[slot].id)), &places.templates[slot]);
  });
  t.offsets.project_all(*t.key_frames.view_of(0), e, places.landmarks);
  t.markers.project_all(*t.key_frames.view_of(0), e, places.markers);
  const Quat turn = exp_rotation(by);
  if (e.revise(places.q, turn) != Status::ok) return;
  t.key_frames.turn(turn);
  for_each_template(t, [&](std::size_t slot, const View& view) {
    const std::uint16_t id = t.templates[slot].id;
    if (places.templates[slot].x > kNowhere.x)
      e.slide_point(id, back_to(places.templates[slot], view, e.point_uv(id), e));
  });
  t.offsets.keep_all(*t.key_frames.view_of(0), e, places.landmarks);
  t.markers.keep_all(*t.key_frames.view_of(0), e, places.markers);
}

bool is_due(const TrackerParts& t, std::size_t view) {
  const bool is_known = t.person->estimate.frames(view) == kPersonEstimateTuning.most_frames;
  return t.frame - t.person->taken_frame >=
         (is_known ? kTuning.interval_when_known : kTuning.interval_frames);
}

void conclude(TrackerParts& t) {
  PersonState& s = *t.person;
  const std::size_t view = PersonEstimate::view_towards(camera_direction(t.estimator.view()));
  if (!s.is_active || !is_due(t, view)) return;
  Arena scratch(t.scratch.data, t.scratch.count);
  PersonEquations equations;
  gather(t, equations, scratch);
  for (std::size_t k = 3; k < s.rows.kept(); ++k) s.now[k] = t.estimator.parameters()[s.rows.identity(k - 3)];
  s.estimate.add(view, equations, s.now);
  s.taken_frame = t.frame;
  if (t.frame - s.step_frame < kTuning.step_frames || !s.estimate.is_usable()) return;
  s.step_frame = t.frame;
  if (!s.estimate.solve(s.start_q, s.sd, equations, s.best)) return;
  Places places;
  places.lay_out(scratch, t.model(), t.limits);
  for (std::size_t k = 0; k < t.start_q.count; ++k) places.q[k] = t.estimator.parameters()[k];
  Vec3 turn;
  if (!choose_step(s, t.model(), places.q, &turn)) return;
  take_step(t, places, turn);
  s.now[0] += turn.x;
  s.now[1] += turn.y;
  s.now[2] += turn.z;
}

}  // namespace

void PersonState::lay_out(Arena& arena, const Model& model) {
  const std::size_t parameters = model.parameters().count, kept = 3 + identities(model);
  rows.lay_out(arena, model);
  estimate.lay_out(arena, kept);
  is_free = arena.take<std::uint8_t>(parameters);
  now = arena.take<float>(kept);
  best = arena.take<float>(kept);
  start_q = arena.take<float>(kept);
  sd = arena.take<float>(kept);
}

const PersonRefinement kPersonRefinement{lay_out, scratch_bytes, start, conclude};

}  // namespace pliant
