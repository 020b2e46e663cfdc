#include "track/realignment.hpp"

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
