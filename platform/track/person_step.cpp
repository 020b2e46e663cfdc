#include "track/person_step.hpp"

#include "estimate/visible_surface.hpp"
#include "track/person_refinement.hpp"
#include "track/person_rows.hpp"
#include "track/tracker_parts.hpp"
#include "track/tracker_sizes.hpp"

namespace pliant {

namespace {

constexpr const PersonRefinementTuning& kTuning = kPersonRefinementTuning;

/// The (u,v) near `uv` that a view sees at x after the step.
Vec2 back_to(Vec2 x, const View& view, Vec2 uv, TrackerParts& t, const PersonStep& step) {
  const Projector projector(view, true);
  for (int k = 0; k < kTuning.slides; ++k) {
    const SurfaceFrame f = t.estimator.surface_frame(uv, step.q);
    Vec2 now;
    Projector::Derivatives d;
    if (!projector.project(f.p, &now, &d)) return uv;
    const Vec2 a = d.along(f.pu), b = d.along(f.pv), r = x - now;
    const float area = a.x * b.y - a.y * b.x;
    if (magnitude(area) < kPersonRowsTuning.least_area * (dot(a, a) + dot(b, b))) return uv;
    const auto limited = [](float by) { return clamp(by, -kTuning.most_slide, kTuning.most_slide); };
    uv = {clamp(uv.x + limited((r.x * b.y - r.y * b.x) / area), 0, 1),
          clamp(uv.y + limited((a.x * r.y - a.y * r.x) / area), 0, 1)};
  }
  return uv;
}

/// Where a template has to lie after the step, so that it stays where its key frame showed it.
Vec2 slid(TrackerParts& t, const PersonStep& step, std::size_t slot, View key) {
  const Vec2 uv = t.estimator.point_uv(t.templates[slot].id);
  Vec2 seen;
  if (!Projector(key, true).project(t.estimator.surface_point(uv), &seen)) return uv;
  key.q = normalised(key.q * exp_rotation(step.turn));
  return back_to(seen, key, uv, t, step);
}

}  // namespace

void PersonStep::lay_out(Arena& arena, const Model& model, const TrackerLimits& limits) {
  q = arena.take<float>(model.parameters().count);
  uv = arena.take<Vec2>(all_slots(limits));
}

void PersonStep::start() {
  is_under_way = false;
  count = changed_frame = 0;
}

void StepPlaces::lay_out(Arena& arena, const Model& model, const TrackerLimits& limits) {
  landmarks = arena.take<Vec2>(model.landmarks().count);
  markers = arena.take<Vec2>(limits.markers);
  moved = arena.take<Vec3>(model.landmarks().count);
}

float person_step_work(const Model& model, const TrackerLimits& limits) {
  return of_cascade(model, kTuning.point_work * static_cast<float>(all_points(limits)) +
                               kTuning.landmark_work * static_cast<float>(model.landmarks().count));
}

void begin_step(TrackerParts& t, PersonStep* step) {
  step->is_under_way = true;
  step->prepared = 0;
  step->prepared_frame = t.progress.frame + 1;
  t.estimator.forget_person();
}

bool prepare_step(TrackerParts& t, PersonStep* step) {
  PersonStep& s = *step;
  if (t.progress.last_kept >= s.prepared_frame) {
    s.prepared = 0;
    s.prepared_frame = t.progress.frame + 1;
  }
  for (std::size_t k = 0; k < t.start_q.count; ++k)
    if (t.model().parameters()[k].group == Group::expression) s.q[k] = t.estimator.parameters()[k];
  const float each = of_cascade(t.model(), kTuning.prepared_work);
  std::size_t key = 0;
  for (std::size_t n = 0; s.prepared < t.templates.count(); ++s.prepared) {
    while (s.prepared >= first_slot(t.limits, key + 1)) ++key;
    const View* const view = t.key_frames.view_of(key);
    if (view == nullptr || !t.templates.is_first(s.prepared)) continue;
    if (n++ == kTuning.prepared_templates || !t.budget.take_now(t.budget.person, each)) return false;
    s.uv[s.prepared] = slid(t, s, s.prepared, *view);
  }
  return true;
}

bool take_step(TrackerParts& t, PersonStep* step) {
  PersonStep& s = *step;
  Estimator& e = t.estimator;
  Arena scratch(t.scratch.data, t.scratch.count);
  StepPlaces places;
  places.lay_out(scratch, t.model(), t.limits);
  t.offsets.project_all(*t.key_frames.view_of(0), e, places.landmarks);
  t.markers.project_all(*t.key_frames.view_of(0), e, places.markers);
  for (std::size_t slot = 0; slot < t.templates.count(); ++slot)
    if (t.templates.is_first(slot)) e.slide_point(t.templates[slot].id, s.uv[slot]);
  s.is_under_way = false;
  const Quat turn = exp_rotation(s.turn);
  if (e.revise(s.q, turn) != Status::ok) return false;
  t.result.pose = pose_of(e.view());
  Quat& smoothed = t.result.smoothed_pose.q;
  if (t.smooths) smoothed = normalised(smoothed * turn);
  t.key_frames.turn(turn);
  t.offsets.keep_all(*t.key_frames.view_of(0), e, places.landmarks, places.moved);
  if (!t.keeps_landmark_offsets) t.offsets.clear();
  if (t.detection != nullptr && t.detection->calls->keep_parts != nullptr)
    t.detection->calls->keep_parts(t, places.moved);
  t.markers.keep_all(*t.key_frames.view_of(0), e, places.markers);
  ++s.count;
  s.changed_frame = t.progress.frame;
  return true;
}

bool is_settled(const TrackerParts& t, const PersonStep& step) {
  return step.count == 0 || t.progress.frame - step.changed_frame > kVisibleSurfaceTuning.renewal_frames;
}

}  // namespace pliant
