#include "track/realignment.hpp"

#include "face/ibug_landmarks.hpp"
#include "track/face_detection_state.hpp"
#include "track/found_track.hpp"
#include "track/frame_worth.hpp"
#include "track/second_look.hpp"
#include "track/tracker_parts.hpp"

namespace pliant {

namespace {

constexpr const RealignmentTuning& kTuning = kRealignmentTuning;

bool is_right(const AlignedFace& face) {
  return face.score >= kTuning.least_score && face.landmark_error <= kTuning.most_error;
}

/// From the last good pose, as the same person.
bool align(TrackerParts& t, const FrameView& frame, FaceDetectionState& detection, AlignedFace* face) {
  const SecondLookState& look = *detection.look;
  const AlignmentRoom room = detection.face_search.room();
  for (std::size_t k = 0; k < t.model().parameters().count; ++k) room.q[k] = t.estimator.parameters()[k];
  const Status status =
      look.modules->refine(*look.aligner, frame, t.estimator.camera(), pose_of(t.estimator.view()),
                           detection.face_search.of_known_person(), face, room.q, room.landmarks);
  return status == Status::ok && is_right(*face);
}

/// Whether an alignment of the mean face in the box of the result comes out there, too.
bool is_confirmed(TrackerParts& t, const FrameView& frame, FaceDetectionState& detection,
                  const AlignedFace& face) {
  const FaceModules& modules = *detection.look->modules;
  FaceAligner& aligner = *detection.look->aligner;
  const Span<const Vec2> found = detection.face_search.room().landmarks;
  Arena scratch(t.unused_between_frames.data, t.unused_between_frames.count);
  const Span<Vec2> again = scratch.take_span<Vec2>(found.count);
  float* const q = scratch.take<float>(t.model().parameters().count);
  PLIANT_ASSERT(!scratch.exhausted());  // a check takes far more of this memory
  const FaceBox box = box_at_landmarks(t.model(), view_of(face.pose, face.camera).s,
                                       [&](std::uint16_t k, Vec2* x) { return *x = found[k], true; });
  AlignedFace other;
  int steps = 0;
  if (modules.begin(aligner, frame, box, face.camera, {}, q, &steps) != Status::ok ||
      modules.advance(aligner, frame, steps, &other, q, again) != Status::ok)
    return false;
  const float distance =
      mean_distance(t.model(), again, [&](std::size_t k, Vec2* x) { return *x = found[k], true; });
  return distance <= kTuning.most_disagreement;
}

/// As anybody, to see whether it is somebody else.
bool is_another(TrackerParts& t, const FrameView& frame, FaceDetectionState& detection, AlignedFace* face) {
  const SecondLookState& look = *detection.look;
  const AlignmentRoom room = detection.face_search.room();
  int steps = 0;
  return look.modules->begin(*look.aligner, frame, box_of_track(t), t.estimator.camera(), {}, room.q,
                             &steps) == Status::ok &&
         look.modules->advance(*look.aligner, frame, steps, face, room.q, room.landmarks) == Status::ok &&
         is_right(*face) && detection.face_search.is_another(*face);
}

}  // namespace

bool realign(TrackerParts& t, const FrameView& frame) {
  auto& detection = *static_cast<FaceDetectionState*>(t.detection);
  SecondLookState& look = *detection.look;
  look.stop(t.budget);  // the aligner is needed here
  AlignedFace face;
  if (!align(t, frame, detection, &face)) return false;
  const float distance = distance_from_track(t, detection.face_search.room().landmarks);
  if (distance > kTuning.most_distance && !is_confirmed(t, frame, detection, face)) return false;
  State measured;
  measured.pose = face.pose;
  measured.q = detection.face_search.room().q;
  if (t.estimator.accept(measured, &t.result) != Status::ok) return false;
  t.key_frames.trust(t.estimator);
  t.bad_frames = 1;  // in a row: the templates may fail as long as they like
  detection.checks.see();
  tell_worth(t.estimator.view(), face.landmark_error, false, &t.result);
  if (++look.realigned < kTuning.most_frames) return true;
  AlignedFace other;
  if (is_another(t, frame, detection, &other))
    detection.begin_anew(t, frame, other);
  else
    detection.renew(t, frame, face.landmark_error);
  return true;
}

}  // namespace pliant
