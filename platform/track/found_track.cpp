// Tracks that begin while another one of the face ends. A start takes as long as three frames of a track, so that it is spread over
// as many (docs/algorithms.md, section 9.2).
#include "track/found_track.hpp"

#include "track/second_look.hpp"
#include "track/tracker_sizes.hpp"

namespace pliant {

namespace {

/// The mesh stays: the face has nearly the same shape.
TrackerOptions with_present_mesh(const TrackerOptions& kept) {
  TrackerOptions options = kept;
  options.estimator.mesh_error_mm = -1;
  return options;
}

/// The templates that a start has left, in the picture of the frame after it. Edges are left to the next one.
void capture_others(TrackerParts& t, const FrameView&) {
  if (t.progress.bad_frames > 0) return;  // the surface is not where the estimator has it
  t.progress.rest = nullptr;
  t.placement.place(t.templates, t.estimator, t.region, t.markers, t.templates.count_first(t.limits.patches),
                    t.limits.patches);
  // With very few templates the start has taken its edges at once.
  if (t.progress.uses_edges && t.edges->count() == 0)
    t.limits.edges->start(t, t.templates.count_first(t.limits.patches));
  t.budget.give_half_to(t.budget.second_look);
  face_detection_of(t).look->is_captured = true;
}

/// Starts with a part of the templates, in the picture that the region has, if that lasts.
template <class Start>
void spread(TrackerParts& t, Start&& start) {
  if (t.limits.keeps_previous) t.first_templates = first_templates(t.limits);
  const bool is_spread = t.first_templates > 0;
  if (t.edges != nullptr) t.edges->forget();
  (void)start();  // a track that cannot begin is lost
  t.first_templates = 0;
  if (is_spread && t.is_started) t.progress.rest = capture_others;  // a check may have ended it
}

void begin(TrackerParts& t, const FrameView& frame, const NextTrack& next) {
  FaceDetectionState& detection = face_detection_of(t);
  if (next.is_same_person)
    detection.renew(t, frame, next.face.landmark_error);
  else
    detection.begin_anew(t, frame, next.face);
}

/// The last frame's picture is there until this one's is built.
void begin_in_last(TrackerParts& t, const FrameView& frame) {
  t.progress.rest = nullptr;
  if (!is_free(t)) return;
  const NextTrack next = face_detection_of(t).look->next;  // a copy: the start ends looks
  FrameView last = frame;
  last.time_ns = next.time_ns;
  begin(t, last, next);
  t.budget.give_half_to(t.budget.second_look);
}

}  // namespace

bool is_free(const TrackerParts& t) {
  return !t.given.identity && !t.given.landmarks && t.markers.count() == 0;
}

bool begin_soon(TrackerParts& t, const FrameView& frame, const NextTrack& next) {
  if (!t.limits.keeps_previous || !is_free(t)) {
    begin(t, frame, next);
    return true;
  }
  face_detection_of(t).look->next = next;
  t.progress.rest = begin_in_last;
  return false;
}

bool begins_soon(const TrackerParts& t) {
  return t.progress.rest == begin_in_last;
}

void FaceDetectionState::begin_anew(TrackerParts& t, const FrameView& view, const AlignedFace& face) {
  StartPose found;
  face_search.set_new_person(face, &person_of(t), &found);
  landmark_error = face.landmark_error;
  spread(t, [&] { return start_found(t, view, found, with_present_mesh(kept.options)); });
}

void FaceDetectionState::renew(TrackerParts& t, const FrameView& view, float error) {
  const StartPose found{t.estimator.camera(), pose_of(t.estimator.view())};
  keep_parameters(t);
  note_person(found.camera);
  marker_count = t.markers.save(t.estimator, markers);
  landmark_error = error;
  const std::uint32_t person_number = t.numbers.person;
  spread(t, [&] { return start(t, view, found, with_present_mesh(kept.options)); });
  t.numbers.person = person_number;  // also if checks have not made the person known yet
}

void FaceDetectionState::resume_at(TrackerParts& t, const FrameView& view, const AlignedFace& face,
                                   const float* q) {
  const std::uint8_t* const is_free = kept.options.is_free;
  for (std::size_t k = 0; k < t.start_q.count; ++k)
    if (is_free == nullptr || is_free[k] != 0) t.start_q[k] = q[k];
  marker_count = 0;
  landmark_error = face.landmark_error;
  const TrackNumbers numbers = t.numbers;
  (void)start(t, view, {face.camera, face.pose}, with_present_mesh(kept.options));
  t.numbers = numbers;  // it is still the caller's start
}

}  // namespace pliant
