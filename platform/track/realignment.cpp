#include "track/realignment.hpp"

#include "base/arrays.hpp"
#include "face/box_selection.hpp"
#include "face/ibug_landmarks.hpp"
#include "face/turned_picture.hpp"
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

/// From that pose, as the same person, into the room of the search.
Status align(TrackerParts& t, const FrameView& frame, FaceDetectionState& detection, const Pose& pose,
             AlignedFace* face) {
  const SecondLookState& look = *detection.look;
  const AlignmentRoom room = detection.face_search.room();
  copy(t.estimator.parameters().data, t.model().parameters().count, room.q);
  return look.modules->refine(*look.aligner, frame, t.estimator.camera(), pose,
                              detection.face_search.of_known_person(), face, room.q, room.landmarks);
}

/// From the mean face in a box, as anybody, with the roll of the last good frame.
Status align_in(const FaceBox& box, TrackerParts& t, const FrameView& frame, const AlignmentRoom& room,
                AlignedFace* face) {
  const SecondLookState& look = *face_detection_of(t).look;
  const float roll = roll_of_turn(turn_of(t.estimator.view().q));
  return align_in_box(*look.modules, *look.aligner, frame, box, roll, t.estimator.camera(), room, face);
}

enum class Found { nowhere, here, begun_anew };

FaceBox box_of(const TrackerParts& t, const AlignedFace& face, Span<const Vec2> landmarks) {
  return box_at_landmarks(t.model(), view_of(face.pose, face.camera).s, places_of(landmarks));
}

/// Beside the room of the search, until the frame ends.
AlignmentRoom take_room(TrackerParts& t) {
  Arena scratch(t.unused_between_frames.data, t.unused_between_frames.count);
  float* const q = scratch.take<float>(t.model().parameters().count);
  const AlignmentRoom room{q, scratch.take_span<Vec2>(t.model().landmarks().count)};
  PLIANT_ASSERT(!scratch.exhausted());  // a check takes far more of this memory
  return room;
}

/// Mean distance of two alignments' landmarks, fraction of the eyes' distance.
float distance_between(const TrackerParts& t, Span<const Vec2> a, Span<const Vec2> b) {
  return mean_distance(t.model(), a, places_of(b));
}

/// Near the last good pose, in `face` and the room of the search. If that is away from there, or not surely right, the mean face is
/// aligned in the box of the result, too. Where that comes out elsewhere, and is far more certain, the next frame begins.
Found find_near(TrackerParts& t, const FrameView& frame, FaceDetectionState& detection, AlignedFace* face) {
  const Span<const Vec2> landmarks = detection.face_search.room().landmarks;
  if (align(t, frame, detection, pose_of(t.estimator.view()), face) != Status::ok ||
      face->score < kTuning.least_seen_score)
    return Found::nowhere;
  const float moved = distance_from_track(t, landmarks);  // negative: a landmark was behind the camera
  if (is_right(*face) && moved >= 0 && moved <= kTuning.most_distance) return Found::here;
  const AlignmentRoom own = take_room(t);
  AlignedFace mean;
  if (align_in(box_of(t, *face, landmarks), t, frame, own, &mean) != Status::ok) return Found::nowhere;
  const float distance = distance_between(t, own.landmarks, landmarks);
  if (distance > kTuning.most_distance && mean.score >= kTuning.least_sure_score &&
      mean.landmark_error <= kTuning.sure_error_ratio * face->landmark_error) {
    detection.look->suspected = box_of(t, mean, own.landmarks);
    return Found::nowhere;
  }
  return is_right(*face) && distance <= kTuning.most_disagreement ? Found::here : Found::nowhere;
}

/// In the box of such a mean face in the frame before: if it has stayed there, it is the same person, who is then aligned from
/// there, or another one, with whom a new track begins.
Found find_at(const FaceBox& box, TrackerParts& t, const FrameView& frame, FaceDetectionState& detection,
              AlignedFace* face) {
  const AlignmentRoom room = detection.face_search.room(), own = take_room(t);
  AlignedFace mean;
  if (align_in(box, t, frame, own, &mean) != Status::ok || mean.score < kTuning.least_sure_score ||
      !is_right(mean) ||
      !is_same(box, box_of(t, mean, own.landmarks), kTuning.most_box_shift, kTuning.most_box_ratio))
    return Found::nowhere;
  copy(own.q, t.model().parameters().count, room.q);
  if (detection.face_search.is_another(mean)) {
    copy(own.landmarks.data, own.landmarks.count, room.landmarks.data);
    detection.begin_anew(t, frame, mean);
    return Found::begun_anew;
  }
  const bool is_there = align(t, frame, detection, mean.pose, face) == Status::ok && is_right(*face) &&
                        distance_between(t, own.landmarks, room.landmarks) <= kTuning.most_disagreement;
  return is_there ? Found::here : Found::nowhere;
}

/// Whether it is somebody else who is tracked.
bool is_another(TrackerParts& t, const FrameView& frame, FaceDetectionState& detection, AlignedFace* face) {
  return align_in(box_of_track(t), t, frame, detection.face_search.room(), face) == Status::ok &&
         is_right(*face) && detection.face_search.is_another(*face);
}

}  // namespace

bool realign(TrackerParts& t, const FrameView& frame) {
  FaceDetectionState& detection = face_detection_of(t);
  SecondLookState& look = *detection.look;
  look.stop(t.budget);  // the aligner is needed here
  const FaceBox suspected = look.suspected;
  look.suspected = {};
  AlignedFace face;
  const Found found = suspected.side > 0 ? find_at(suspected, t, frame, detection, &face)
                                         : find_near(t, frame, detection, &face);
  if (found != Found::here) return found == Found::begun_anew;
  State measured;
  measured.pose = face.pose;
  measured.q = detection.face_search.room().q;
  if (t.estimator.accept(measured, &t.result) != Status::ok) return false;
  t.key_frames.trust(t.estimator);
  t.progress.bad_frames = 1;  // in a row: the templates may fail as long as they like
  detection.checks.see();
  tell_worth(t.estimator.view(), face.landmark_error, false, &t.result);
  if (++look.realigned < kTuning.most_frames) return true;
  AlignedFace other;
  const bool is_same = !is_another(t, frame, detection, &other);
  begin_soon(t, frame, {is_same ? face : other, is_same, frame.time_ns});
  return true;
}

void resume(TrackerParts& t, const FrameView& frame) {
  FaceDetectionState& detection = face_detection_of(t);
  const AlignmentRoom room = detection.face_search.room();
  AlignedFace face;
  if (t.markers.count() > 0 || align(t, frame, detection, pose_of(t.estimator.view()), &face) != Status::ok ||
      !is_right(face) || !(distance_from_track(t, room.landmarks) > kTuning.least_resumed))
    return;
  detection.resume_at(t, frame, face, room.q);
}

}  // namespace pliant
