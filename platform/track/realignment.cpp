#include "track/realignment.hpp"

#include "base/arrays.hpp"
#include "face/box_selection.hpp"
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

/// Aligns from `pose`, with the known person held. Results go to the room of the search.
Status align_known(TrackerParts& t, const FrameView& frame, FaceAligner& aligner, const Pose& pose,
                   AlignedFace* face) {
  FaceSearch& search = face_detection_of(t).face_search;
  const AlignmentRoom room = search.room();
  copy(t.estimator.parameters().data, t.model().parameters().count, room.q);
  return t.limits.detection->modules->refine(aligner, frame, t.estimator.camera(), pose,
                                             search.of_known_person(), face, room.q, room.landmarks);
}

/// The alignments of one frame.
struct Alignments {
  TrackerParts& t;
  const FrameView& frame;
  FaceDetectionState& detection;
  FaceAligner& aligner;
  AlignmentRoom own;  // beside the room of the search

  const FaceModules& modules() const { return *detection.look->modules; }
  AlignmentRoom room() const { return detection.face_search.room(); }

  Status align(const Pose& pose, AlignedFace* face) const {
    return align_known(t, frame, aligner, pose, face);
  }

  /// Aligns the mean face in a box, all parameters free, with the roll of the last good frame. Results go to `to`.
  Status align_in(const FaceBox& box, const AlignmentRoom& to, AlignedFace* face) const {
    return align_in_box(modules(), aligner, frame, box, roll_of_track(t), t.estimator.camera(), to, face);
  }
};

/// Lays out the aligner, and the room of its own, in memory that is unused between frames.
Alignments begin(TrackerParts& t, const FrameView& frame) {
  FaceDetectionState& detection = face_detection_of(t);
  Arena scratch(t.unused_between_frames.data, t.unused_between_frames.count);
  FaceAligner& aligner = detection.look->in(scratch);
  float* const q = scratch.take<float>(t.model().parameters().count);
  const AlignmentRoom own{q, scratch.take_span<Vec2>(t.model().landmarks().count)};
  PLIANT_ASSERT(!scratch.exhausted());  // alignment_bytes
  return {t, frame, detection, aligner, own};
}

FaceBox box_of(const TrackerParts& t, const AlignedFace& face, Span<const Vec2> landmarks) {
  return box_at_landmarks(t.model(), view_of(face.pose, face.camera).s, places_of(landmarks));
}

/// Mean distance of two alignments' landmarks, fraction of the eyes' distance.
float distance_between(const TrackerParts& t, Span<const Vec2> a, Span<const Vec2> b) {
  return mean_distance(t.model(), a, places_of(b));
}

/// Aligns from the last good pose. If the result is away from there, or not right, the mean face is aligned in its box, too. Where
/// that comes out elsewhere, and is far more certain, the next frame begins there (find_at).
/// \param face  out: the first alignment; its parameters and landmarks are in the room of the search.
/// \param used_mean  out: the mean face was aligned.
Realigned find_near(const Alignments& a, AlignedFace* face, bool* used_mean) {
  TrackerParts& t = a.t;
  const Span<const Vec2> landmarks = a.room().landmarks;
  if (a.align(pose_of(t.estimator.view()), face) != Status::ok || face->score < kTuning.least_seen_score)
    return Realigned::nowhere;
  const float moved = distance_from_track(t, landmarks);  // negative: a landmark was behind the camera
  if (is_right(*face) && moved >= 0 && moved <= kTuning.most_distance) return Realigned::here;
  *used_mean = true;
  AlignedFace mean;
  if (a.align_in(box_of(t, *face, landmarks), a.own, &mean) != Status::ok) return Realigned::nowhere;
  const float distance = distance_between(t, a.own.landmarks, landmarks);
  if (distance > kTuning.most_distance && mean.score >= kTuning.least_sure_score &&
      mean.landmark_error <= kTuning.sure_error_ratio * face->landmark_error) {
    a.detection.look->suspected = box_of(t, mean, a.own.landmarks);
    return Realigned::nowhere;
  }
  return is_right(*face) && distance <= kTuning.most_disagreement ? Realigned::here : Realigned::nowhere;
}

/// Aligns the mean face in the box that find_near found for it in the frame before. If it has stayed there, it is the known person,
/// who is then aligned from its pose, or another one, with whom a new track begins.
Realigned find_at(const FaceBox& box, const Alignments& a, AlignedFace* face) {
  TrackerParts& t = a.t;
  AlignedFace mean;
  if (a.align_in(box, a.own, &mean) != Status::ok || mean.score < kTuning.least_sure_score ||
      !is_right(mean) ||
      !is_same(box, box_of(t, mean, a.own.landmarks), kTuning.most_box_shift, kTuning.most_box_ratio))
    return Realigned::nowhere;
  copy(a.own.q, t.model().parameters().count, a.room().q);
  if (a.detection.face_search.is_another(mean)) {
    copy(a.own.landmarks.data, a.own.landmarks.count, a.room().landmarks.data);
    return begin_soon(t, a.frame, {mean, false, a.frame.time_ns}) ? Realigned::begun_anew
                                                                  : Realigned::nowhere;
  }
  const bool is_there = a.align(mean.pose, face) == Status::ok && is_right(*face) &&
                        distance_between(t, a.own.landmarks, a.room().landmarks) <= kTuning.most_disagreement;
  return is_there ? Realigned::here : Realigned::nowhere;
}

/// Whether it is somebody else who is tracked.
bool is_another(const Alignments& a, AlignedFace* face) {
  return a.align_in(box_of_track(a.t), a.room(), face) == Status::ok && is_right(*face) &&
         a.detection.face_search.is_another(*face);
}

/// An alignment whose parameters are in the room of the search.
State state_of(TrackerParts& t, const AlignedFace& face) {
  State state;
  state.pose = face.pose;
  state.q = face_detection_of(t).face_search.room().q;
  return state;
}

/// Ends a bad frame as a tracked one: its state is that of an alignment.
bool take(TrackerParts& t, const AlignedFace& face) {
  FaceDetectionState& detection = face_detection_of(t);
  if (t.estimator.accept(state_of(t, face), &t.result) != Status::ok) return false;
  t.key_frames.trust(t.estimator);
  t.progress.bad_frames = 1;  // in a row: the templates may fail as long as they like
  detection.checks.see();
  tell_worth(t.estimator.view(), face.landmark_error, false, &t.result);
  return true;
}

}  // namespace

SearchFrom align_ahead(TrackerParts& t, const FrameView& frame) {
  SecondLookState& look = *face_detection_of(t).look;
  look.ahead = Realigned::untried;
  const int bad = t.progress.bad_frames;
  if (bad > 0 && look.suspected.side > 0) return SearchFrom::nowhere;
  if (bad != 1 || look.realigned == 0) return SearchFrom::prediction;  // the last frame was not aligned
  if (look.realigned + 1 >= kTuning.most_frames) return SearchFrom::nowhere;
  look.stop(t.budget);  // the aligner is needed here
  t.budget.give_half_to(t.budget.second_look);
  bool used_mean = false;
  look.ahead = find_near(begin(t, frame), &look.face_ahead, &used_mean);
  if (used_mean) return SearchFrom::nowhere;
  return look.ahead == Realigned::here ? SearchFrom::alignment : SearchFrom::prediction;
}

void move_to_alignment(TrackerParts& t) {
  // A pose that the estimator refuses, as `take` would, leaves its prediction.
  static_cast<void>(t.estimator.restore(state_of(t, face_detection_of(t).look->face_ahead)));
}

bool realign(TrackerParts& t, const FrameView& frame) {
  SecondLookState& look = *face_detection_of(t).look;
  AlignedFace face = look.face_ahead;
  Realigned found = look.ahead;
  look.stop(t.budget);  // the aligner is needed here
  const Alignments alignments = begin(t, frame);
  if (found == Realigned::untried) {
    const FaceBox suspected = look.suspected;
    look.suspected = {};
    bool used_mean = false;
    found =
        suspected.side > 0 ? find_at(suspected, alignments, &face) : find_near(alignments, &face, &used_mean);
  }
  if (found != Realigned::here) return found == Realigned::begun_anew;
  if (!take(t, face)) return false;
  if (++look.realigned < kTuning.most_frames) return true;
  AlignedFace other;
  const bool is_same = !is_another(alignments, &other);
  begin_soon(t, frame, {is_same ? face : other, is_same, frame.time_ns});
  return true;
}

bool realign_near(TrackerParts& t, const FrameView& frame) {
  Arena scratch(t.unused_between_frames.data, t.unused_between_frames.count);
  FaceAligner* const aligner = t.limits.detection->modules->lay_out_for_known_person(scratch, t.model());
  PLIANT_ASSERT(!scratch.exhausted());  // check_bytes
  AlignedFace face;
  if (aligner == nullptr ||
      align_known(t, frame, *aligner, pose_of(t.estimator.view()), &face) != Status::ok || !is_right(face))
    return false;
  const float moved = distance_from_track(t, face_detection_of(t).face_search.room().landmarks);
  return moved >= 0 && moved <= kTuning.most_distance_alone && take(t, face);
}

void resume(TrackerParts& t, const FrameView& frame) {
  const Alignments alignments = begin(t, frame);
  AlignedFace face;
  if (t.markers.count() > 0 || alignments.align(pose_of(t.estimator.view()), &face) != Status::ok ||
      !is_right(face) || !(distance_from_track(t, alignments.room().landmarks) > kTuning.least_resumed))
    return;
  alignments.detection.resume_at(t, frame, face, alignments.room().q);
}

std::size_t alignment_bytes(const Model& model) {
  Arena own;
  own.take<float>(model.parameters().count);
  own.take<Vec2>(model.landmarks().count);
  return FaceAligner::scratch_bytes(model) + own.used_bytes() + 2 * Arena::kAlignment;
}

}  // namespace pliant
