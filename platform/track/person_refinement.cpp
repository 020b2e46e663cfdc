#include "track/person_refinement.hpp"

#include "base/arrays.hpp"
#include "estimate/lens_transfer.hpp"
#include "model/parameters.hpp"
#include "track/landmark_fit.hpp"
#include "track/person_estimate.hpp"
#include "track/person_rows.hpp"
#include "track/person_step.hpp"
#include "track/tracker_parts.hpp"

namespace pliant {

/// In the arena.
struct PersonState {
  PersonRows rows;
  PersonEstimate estimate;
  std::uint8_t* is_free = nullptr;
  float *now = nullptr, *best = nullptr;    // rotation against the start, then identity
  float *start_q = nullptr, *sd = nullptr;  // identity: of the start; of the population
  bool is_active = false;
  std::uint32_t taken_frame = 0;  // the last one that was taken
  std::uint32_t step_frame = 0;   // the last in which a step was chosen

  PersonStep step;

  void lay_out(Arena& arena, const Model& model, const TrackerLimits& limits);
};

namespace {

constexpr const PersonRefinementTuning& kTuning = kPersonRefinementTuning;
constexpr float kExact = 1e6f;  // weight of what has no error of its own, 1/rad^2 or 1/px^2

PersonState* lay_out(Arena& arena, const Model& model, const TrackerLimits& limits) {
  arena.count_as(Purpose::state);
  return count_of(Group::identity, model) > 0 ? create_part<PersonState>(arena, model, limits) : nullptr;
}

std::size_t scratch_bytes(const Model& model, const TrackerLimits& limits) {
  if (count_of(Group::identity, model) == 0) return 0;
  Arena trial;
  PersonEquations equations;
  equations.lay_out(trial, kPoseUnknowns + 3 + model.parameters().count);
  StepPlaces places;  // of another frame
  places.lay_out(trial, model, limits);
  return trial.used_bytes() + PersonRows::scratch_bytes(model) + Arena::kAlignment;
}

void start(TrackerParts& t, const TrackerOptions& options) {
  PersonState& s = *t.person;
  const Span<const Parameter> all = t.model().parameters();
  s.is_active = !t.given.identity;
  for (std::size_t k = 0; k < all.count; ++k) {
    const bool is_identity = all[k].group == Group::identity;
    s.is_free[k] = options.is_free != nullptr ? options.is_free[k] : static_cast<std::uint8_t>(!is_identity);
    s.is_active = s.is_active && !(is_identity && s.is_free[k] != 0);
  }
  s.rows.start(t.model(), s.is_free);
  s.estimate.clear();
  s.taken_frame = s.step_frame = 0;
  s.step.start();
  for (std::size_t k = 0; k < 3; ++k) s.now[k] = 0;
  for (std::size_t k = 3; k < s.rows.kept(); ++k) {
    s.sd[k - 3] = kTuning.start_sd * all[s.rows.identity(k - 3)].sd;
    s.start_q[k - 3] = t.estimator.parameters()[s.rows.identity(k - 3)];
  }
}

/// Key frame of the first template of a point; null where it has none. \param begin  the template's slot or one before, then
/// the template's: observations are in the order of slots.
const View* key_of(const TrackerParts& t, std::uint16_t id, std::size_t* begin) {
  for (std::size_t slot = *begin; slot < t.templates.count(); ++slot) {
    if (!t.templates.is_first(slot) || t.templates[slot].id != id) continue;
    *begin = slot;
    return t.key_frames.view_of(t.templates.key_of(slot));
  }
  return nullptr;
}

/// Whether an observation says something of the person.
bool is_usable(const Observation& o) {
  return o.reason == Reason::found && o.cue != Cue::flow;
}

/// The interval at which observations are taken, for which the frame's budget has room; 0: it has not enough.
std::size_t choose_interval(TrackerParts& t) {
  std::size_t usable = 0;
  for (std::size_t k = 0; k < t.observation_count; ++k) usable += is_usable(t.observations[k]);
  const float each = of_cascade(t.model(), kTuning.observation_work);
  const float room = max(t.budget.left_for(t.budget.person), 0) / each;
  const float most = min(room, static_cast<float>(kTuning.most_observations - 1));
  if (most < static_cast<float>(kTuning.least_observations)) return 0;
  const std::size_t interval = usable / (static_cast<std::size_t>(most) + 1) + 1;
  t.budget.take_now(t.budget.person, each * static_cast<float>(usable / interval));
  return interval;
}

/// The equations of a frame, of each observation in `interval`, in turn from frame to frame.
void gather(TrackerParts& t, std::size_t interval, PersonEquations& equations, Arena& scratch) {
  PersonState& s = *t.person;
  equations.lay_out(scratch, s.rows.count());
  equations.reset();
  s.rows.begin(scratch, t.model(), t.estimator.view(), t.estimator.parameters().data);
  std::size_t seen = t.progress.frame, slot = 0;
  for (std::size_t k = 0; k < t.observation_count; ++k) {
    Observation o = t.observations[k];
    if (!is_usable(o) || seen++ % interval != 0) continue;
    const View* const key = o.cue == Cue::patch ? key_of(t, o.id, &slot) : nullptr;
    if (o.cue == Cue::patch && key == nullptr) continue;
    if (!t.estimator.lens().is_none()) undistort(t.estimator.lens(), {&o, 1});
    s.rows.add(o, t.estimator.point_uv(o.id), t.estimator.point_frame(o.id), key, equations);
  }
  s.rows.add_priors(equations);
  equations.eliminate(s.rows.count() - s.rows.kept());
}

/// The equations of the landmarks in frame 0, as far as they are places of the face. Those that the start did not see are where it
/// put the model. The frame's rotation is that of the start.
void gather_landmarks(TrackerParts& t, PersonEquations& equations, Arena& scratch) {
  PersonState& s = *t.person;
  const View& view = *t.key_frames.view_of(0);
  const float* const q = t.estimator.parameters().data;
  const Projector projector(view, true);
  equations.lay_out(scratch, s.rows.count());
  equations.reset();
  s.rows.begin(scratch, t.model(), view, q);
  for (std::size_t k = 0; k < t.model().landmarks().count; ++k) {
    const Landmark& l = t.model().landmarks()[k];
    if (is_silhouette_landmark(l.name)) continue;
    const Vec2 uv = l.uv();
    const SurfaceFrame surface = t.estimator.surface_frame(uv, q);
    Observation o{};
    o.cue = Cue::patch;
    o.information = {kExact, 0, kExact};  // what is left is the model's error
    if (projector.project(surface.p + t.offsets.values()[k], &o.x))
      s.rows.add(o, uv, surface, nullptr, equations);
  }
  s.rows.add_priors(equations);
  for (std::size_t k = 0; k < 3; ++k) equations.add_prior(k, 0, kExact);
  equations.eliminate(s.rows.count() - s.rows.kept());
  equations.count_from_zero(s.rows.count() - s.rows.kept(), s.now);
}

/// The step towards the best value: of the rotation and, in `q`, of the identity. \return false where it is too small.
bool choose_step(PersonState& s, const Model& model, float* q, Vec3* turn) {
  const float rate = s.step.count < kTuning.whole_steps ? 1 : kTuning.later_rate;
  bool is_worth = false;
  float step[3];
  for (std::size_t k = 0; k < 3; ++k) {
    step[k] = rate * (s.best[k] - s.now[k]);
    is_worth = is_worth || magnitude(step[k]) > kTuning.least_turn;
  }
  for (std::size_t k = 3; k < s.rows.kept(); ++k) {
    const Parameter& p = model.parameters()[s.rows.identity(k - 3)];
    const float to = within_range(p, s.now[k] + rate * (s.best[k] - s.now[k]));
    is_worth = is_worth || magnitude(to - s.now[k]) > kTuning.least_step_sd * p.sd;
    q[s.rows.identity(k - 3)] = to;
  }
  *turn = {step[0], step[1], step[2]};
  return is_worth;
}

bool is_due(const TrackerParts& t, std::size_t view) {
  const bool is_known = t.person->estimate.frames(view) == kPersonEstimateTuning.most_frames;
  return t.progress.frame - t.person->taken_frame >=
         (is_known ? kTuning.interval_when_known : kTuning.interval_frames);
}

void note_now(TrackerParts& t) {
  PersonState& s = *t.person;
  for (std::size_t k = 3; k < s.rows.kept(); ++k) s.now[k] = t.estimator.parameters()[s.rows.identity(k - 3)];
}

/// Takes the frame into the estimate, if there is room for it.
void take_frame(TrackerParts& t, std::size_t view) {
  PersonState& s = *t.person;
  const std::size_t interval = choose_interval(t);
  if (interval == 0) return;
  Arena scratch(t.scratch.data, t.scratch.count);
  PersonEquations equations;
  gather(t, interval, equations, scratch);
  note_now(t);
  s.estimate.add(view, equations, s.now);
  s.taken_frame = t.progress.frame;
}

/// Whether a step towards the estimate has to be chosen: it has changed since the last one.
bool is_step_due(const TrackerParts& t) {
  const PersonState& s = *t.person;
  return !s.step.is_under_way && s.taken_frame > s.step_frame &&
         t.progress.frame - s.step_frame >= kTuning.step_frames && s.estimate.is_usable();
}

/// Chooses the next step, if there is room for it.
void plan_step(TrackerParts& t) {
  PersonState& s = *t.person;
  const float all = static_cast<float>(t.model().landmarks().count);
  const float work = of_cascade(t.model(), kTuning.observation_work) * all;
  if (!t.budget.take_now(t.budget.person, work)) return;
  Arena scratch(t.scratch.data, t.scratch.count);
  PersonEquations equations;
  note_now(t);
  gather_landmarks(t, equations, scratch);
  s.step_frame = t.progress.frame;
  if (!s.estimate.solve(s.start_q, s.sd, equations, s.best)) return;
  copy(t.estimator.parameters().data, t.start_q.count, s.step.q);
  if (choose_step(s, t.model(), s.step.q, &s.step.turn)) begin_step(t, &s.step);
}

void conclude(TrackerParts& t) {
  PersonState& s = *t.person;
  if (!s.is_active) return;
  const std::size_t view = PersonEstimate::view_towards(camera_direction(t.estimator.view()));
  if (is_step_due(t)) return plan_step(t);
  if (is_due(t, view)) take_frame(t, view);
  if (!s.step.is_under_way || !prepare_step(t, &s.step) || !is_settled(t, s.step)) return;
  if (!t.budget.take(t.budget.person, person_step_work(t.model(), t.limits)) || !take_step(t, &s.step))
    return;
  s.now[0] += s.step.turn.x;
  s.now[1] += s.step.turn.y;
  s.now[2] += s.step.turn.z;
}

}  // namespace

void PersonState::lay_out(Arena& arena, const Model& model, const TrackerLimits& limits) {
  const std::size_t parameters = model.parameters().count, kept = 3 + count_of(Group::identity, model);
  rows.lay_out(arena, model);
  estimate.lay_out(arena, kept);
  is_free = arena.take<std::uint8_t>(parameters);
  now = arena.take<float>(kept);
  best = arena.take<float>(kept);
  start_q = arena.take<float>(kept);
  sd = arena.take<float>(kept);
  step.lay_out(arena, model, limits);
}

const PersonRefinement kPersonRefinement{lay_out, scratch_bytes, start, conclude};

}  // namespace pliant
