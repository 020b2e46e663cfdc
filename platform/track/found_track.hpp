#pragma once
// What searches and second looks share. Inline: a program without second looks links nothing of found_track.cpp's starts.
#include "face/ibug_landmarks.hpp"
#include "face/turned_picture.hpp"
#include "track/face_detection_state.hpp"
#include "track/tracker_parts.hpp"

namespace pliant {

struct NextTrack;

/// The face box of a track, as its parameters have it; side 0 if the model has no such landmarks.
inline FaceBox box_of_track(TrackerParts& t) {
  const auto place = [&](std::uint16_t k, Vec2* x) { return t.offsets.project(k, t.estimator, x); };
  return box_at_landmarks(t.model(), t.estimator.view().s, place);
}

/// The roll with which an alignment in that box begins, as after a search: of an upright head it is 0.
inline float roll_of_track(TrackerParts& t) {
  return roll_of_turn(turn_of(t.estimator.view().q));
}

/// Mean distance of landmarks from the tracked ones, over that of their outer eye corners. Negative if one is behind the camera.
inline float distance_from_track(TrackerParts& t, Span<const Vec2> landmarks) {
  return mean_distance(t.model(), landmarks,
                       [&](std::size_t k, Vec2* x) { return t.offsets.project(k, t.estimator, x); });
}

/// The detection state. \pre the tracker's detection is of faces.
inline FaceDetectionState& face_detection_of(TrackerParts& t) {
  return *static_cast<FaceDetectionState*>(t.detection);
}

/// The person whom the tracker knows: in its memory.
inline KnownPerson& person_of(TrackerParts& t) {
  KnownPerson& person = face_detection_of(t).person;
  person.q = t.start_q.data;
  person.offsets = &t.offsets;
  return person;
}

/// Whether the caller has said nothing that a new start would lose: who it is, or where landmarks or markers are.
bool is_free(const TrackerParts& t);

/// Begins a new track in the picture of this frame: with the next call of `update` if the picture is kept until then
/// (TrackerLimits::keeps_previous) and the caller has given nothing (is_free), since this frame still belongs to the track that
/// ends; else at once. \return whether it began at once.
bool begin_soon(TrackerParts& t, const FrameView& frame, const NextTrack& next);
/// Whether the next frame begins such a track.
bool begins_soon(const TrackerParts& t);

/// Centres the crops of the part readers, and notes how this person's parts differ from the model.
void calibrate_parts(TrackerParts& t, const FrameView& view);

/// Starts the track of a face that was found, with the person as TrackerParts::start_q and FaceDetectionState::person have it.
/// \return the status of TrackerParts::start.
inline Status start_found(TrackerParts& t, const FrameView& frame, const StartPose& found,
                          const TrackerOptions& options) {
  FaceDetectionState& detection = face_detection_of(t);
  if (!detection.person.is_known) {
    t.given = {};
    t.keeps_landmark_offsets = options.keeps_landmark_offsets;
    detection.marker_count = 0;
  }
  return detection.start(t, frame, found, options);
}

}  // namespace pliant
