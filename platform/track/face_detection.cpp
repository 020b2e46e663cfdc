// What connects FaceSearch and FaceChecks with the tracker.
#include <new>

#include "base/integers.hpp"
#include "track/face_detection_state.hpp"
#include "track/found_track.hpp"
#include "track/realignment.hpp"
#include "track/second_look.hpp"
#include "track/tracker_parts.hpp"

namespace pliant {

namespace {

/// Tuning of part readers in a track. Each constant: unit, reason, experiment.
struct PartTrackingTuning {
  /// Time between readings in which lids and gaze change, ns: not so little that they are held, and not so much that a pause frees
  /// them. Where the clock stands still it is that of 25 frames a second. Round values, not tuned.
  std::uint32_t shortest_ns = 10'000'000, longest_ns = 200'000'000, usual_ns = 40'000'000;
};
constexpr PartTrackingTuning kPartTracking{};

bool is_available(const Model& model, const TrackerLimits& limits) {
  return limits.width <= kLargestFramePx && limits.height <= kLargestFramePx &&
         limits.detection->modules->is_available(model);
}

extern const DetectionCalls kFaceCalls;

}  // namespace

void FaceDetectionState::lay_out(Arena& arena, const Model& model, const TrackerLimits& limits) {
  DetectionState::lay_out(arena, &kFaceCalls, model, limits);
  face_search.lay_out(arena, model, limits);
  checks.lay_out(limits);
  if (limits.second_look != nullptr) look = limits.second_look->lay_out(arena, model, limits);
  parts = arena.make<PartPoints>();
  if (parts != nullptr && parts->open(model) != Status::ok) parts = nullptr;
}

namespace {

DetectionState* lay_out(Arena& arena, const Model& model, const TrackerLimits& limits, std::size_t* bytes) {
  if (!is_available(model, limits)) return nullptr;
  *bytes = search_bytes(model, limits);
  return create_part<FaceDetectionState>(arena, model, limits);
}

std::size_t bytes_of_check(const Model& model, const TrackerLimits& limits) {
  if (!is_available(model, limits)) return 0;
  // Of a model with many expressions a check may take more than an alignment.
  const std::size_t check = check_bytes(model, limits);
  return limits.second_look == nullptr ? check : larger(check, limits.second_look->bytes(model));
}

std::size_t bytes_of_reading(const Model& model, const TrackerLimits& limits) {
  if (!is_available(model, limits) || model.parts().empty()) return 0;
  Arena trial;
  create_part<PartFit>(trial, model);
  return trial.used_bytes();
}

void begin_search(TrackerParts& t, const StartOptions& start, const TrackerOptions& options) {
  FaceDetectionState& self = face_detection_of(t);
  self.face_search.expect({}, {});
  self.face_search.begin();
  self.checks.forget_poor();
  self.person.is_known = false;
  self.begin_search(t, start, options);
}

Status search(TrackerParts& t, const FrameView& view) {
  FaceDetectionState& self = face_detection_of(t);
  if (!t.block.is_of_search) {
    new (&t.estimator) Estimator();
    self.face_search.begin();
    t.block.is_of_search = true;
  }
  StartPose found;
  Status status = self.face_search.search({view, t.block.bytes, self.kept.start}, &person_of(t), &found,
                                          &self.landmark_error);
  if (status != Status::ok) return status == Status::not_found ? Status::ok : status;
  TrackerOptions options = self.kept.options;
  // To refine the mesh takes as long as two frames of the track, which does not depend on it.
  if (self.face_search.spreads_work()) options.estimator.mesh_error_mm = 0;
  status = start_found(t, view, found, options);
  if (status == Status::too_few_points) self.face_search.expect_again(found.pose.q);
  return answer_of(status);
}

void end_search(TrackerParts& t) {
  t.lay_out_tracking();
}

void refine(TrackerParts& t, const FrameView& view, const RoughStart& rough, StartPose* from) {
  FaceDetectionState& self = face_detection_of(t);
  self.of_caller = &rough.options;
  self.landmark_error = 0;       // a start before may have failed
  self.person.is_known = false;  // also if this one does: it overwrites what is known
  self.marker_count = 0;
  self.checks.forget_poor();
  self.face_search.forget();
  if (rough.points >= kFaceSearchTuning.enough_points) return;
  self.face_search.refine({view, t.block.bytes, rough.options}, rough.box, &person_of(t), from,
                          &self.landmark_error);
  t.lay_out_tracking();
}

void give_up(TrackerParts& t) {
  FaceDetectionState& self = face_detection_of(t);
  self.note_person(t.estimator.camera());
  self.marker_count = t.markers.save(t.estimator, self.markers);  // for the known person only (start_found)
  self.face_search.expect(box_of_track(t), t.estimator.view().q);
  DetectionState::give_up(t);
}

void conclude(TrackerParts& t, const FrameView& view) {
  FaceDetectionState& self = face_detection_of(t);
  constexpr float kWork = kFaceChecksTuning.check_work;
  WaitingWork& check = t.budget.check;
  const bool is_bad = t.progress.bad_frames > 0;
  bool goes_on = is_bad;
  if (!is_bad) {
    const bool checks = self.checks.is_due() && t.budget.take(check, kWork);
    goes_on = self.checks.conclude(view, t.estimator, checks, t.unused_between_frames, &t.result) &&
              !self.poor_start.is_over(view, t.estimator) &&
              !(self.look == nullptr && self.checks.has_stayed_poor() && is_free(t));
    if (self.parts != nullptr && !self.checks.is_refuted()) t.result.gaze = self.parts->gaze;
  }
  const SecondLook* const second = self.look != nullptr ? t.limits.second_look : nullptr;
  if (goes_on && (second != nullptr ? second->conclude(t, view) : is_bad && realign_near(t, view))) return;
  if (is_bad)
    goes_on = self.checks.endure(t.result, t.progress.bad_frames, t.key_frames.count()) &&
              (second == nullptr || !second->is_over(t));
  if (!goes_on) give_up(t);
  if (t.result.state == TrackState::tracking && self.poor_start.is_doubtful(t.result.landmark_error))
    t.result.state = TrackState::degraded;
  if (self.checks.is_urgent() || is_bad) check.hurry(kWork);
}

/// \return null if there are no readers.
PartFit* read_at_view(TrackerParts& t, const FrameView& view, float centring) {
  FaceDetectionState& self = face_detection_of(t);
  if (self.parts == nullptr) return nullptr;
  Arena arena(t.scratch.data, t.scratch.count);
  PartFit* const fit = create_part<PartFit>(arena, t.model());
  if (fit == nullptr || arena.exhausted()) return nullptr;
  fit->read(view, t.estimator.lens(), t.estimator.view(), t.estimator.parameters().data, centring,
            self.parts);
  return fit;
}

/// ns. Times come from outside: one that goes back counts as a pause.
std::uint32_t time_to_change(std::int64_t last_ns, std::int64_t now_ns) {
  const std::uint64_t elapsed = static_cast<std::uint64_t>(now_ns) - static_cast<std::uint64_t>(last_ns);
  if (elapsed >= kPartTracking.longest_ns) return kPartTracking.longest_ns;
  if (elapsed == 0) return kPartTracking.usual_ns;
  const auto less = static_cast<std::uint32_t>(elapsed);
  return less < kPartTracking.shortest_ns ? kPartTracking.shortest_ns : less;
}

void read_parts(TrackerParts& t, const FrameView& view) {
  FaceDetectionState& self = face_detection_of(t);
  if (self.parts == nullptr) return;
  PartPoints& points = *self.parts;
  if (t.progress.bad_frames > 0) points.gaze = {};  // what a bad frame showed there may be no eyes
  if (PartFit* const fit = read_at_view(t, view, kPartFitTuning.centring); fit != nullptr) {
    const float seconds = 1e-9f * static_cast<float>(time_to_change(self.last_read_ns, view.time_ns));
    fit->fit(seconds, &points);
    points.gaze = smoothed_gaze(points.gaze, fit->gaze(points), seconds);
    self.last_read_ns = view.time_ns;
  }
  for (std::size_t k = 0; k < points.parameter_count; ++k)
    if (points.sd[k] > 0) t.estimator.expect(points.parameter[k], points.last[k], points.sd[k]);
}

void keep_parts(TrackerParts& t, const Vec3* moved) {
  FaceDetectionState& self = face_detection_of(t);
  if (self.parts != nullptr) self.parts->move(t.estimator.view(), moved);
}

}  // namespace

void calibrate_parts(TrackerParts& t, const FrameView& view) {
  FaceDetectionState& self = face_detection_of(t);
  if (self.parts == nullptr) return;
  for (std::size_t s = 0; s < self.parts->side_count; ++s) self.parts->side[s].centre_mm = {};
  for (int k = 0; k < kPartFitTuning.start_centrings; ++k) read_at_view(t, view, 1);
  if (PartFit* const fit = read_at_view(t, view, 0); fit != nullptr) {
    fit->calibrate(self.parts);
    self.parts->gaze = fit->gaze(*self.parts);
  }
}

namespace {

void begin_track(TrackerParts& t, const FrameView& view, const TrackerOptions& options) {
  FaceDetectionState& self = face_detection_of(t);
  if (self.keep_start_of_caller(options))
    self.person.is_known = false;
  else if (!self.person.is_known)
    ++t.numbers.person;
  if (self.look != nullptr) t.limits.second_look->begin_track(t);
  self.last_read_ns = view.time_ns;
  calibrate_parts(t, view);
  self.poor_start.begin(t.result.tracked, t.limits.patches, view, t.estimator);
  self.checks.begin_track(self.landmark_error, self.person.is_known);
  t.budget.check.is_reserved = true;
  conclude(t, view);
}

const DetectionCalls kFaceCalls{begin_search, search,   end_search, refine,
                                begin_track,  conclude, read_parts, keep_parts};

}  // namespace

const Detection kUprightFaceDetection{lay_out, bytes_of_check, bytes_of_reading, &kFaceModules};
const Detection kFaceDetection{lay_out, bytes_of_check, bytes_of_reading, &kRolledFaces};

}  // namespace pliant
