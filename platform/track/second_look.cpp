#include "track/second_look.hpp"

#include "face/ibug_landmarks.hpp"
#include "model/ibug_names.hpp"
#include "track/face_detection_state.hpp"
#include "track/found_track.hpp"
#include "track/known_person.hpp"
#include "track/landmark_fit.hpp"
#include "track/realignment.hpp"
#include "track/tracker_parts.hpp"

namespace pliant {

void SecondLookState::lay_out(Arena& arena, const Model& model, const TrackerLimits& limits) {
  modules = limits.detection->modules;
  aligner = arena.make<FaceAligner>();
  FaceAligner measured;
  (aligner == nullptr ? measured : *aligner).lay_out_spread(arena, model);
}

FaceAligner& SecondLookState::in(Arena& scratch) {
  aligner->lay_out_scratch(scratch);
  PLIANT_ASSERT(!scratch.exhausted());  // SecondLook::bytes
  return *aligner;
}

FaceAligner& SecondLookState::in_scratch_of(const TrackerParts& t) {
  Arena scratch(t.unused_between_frames.data, t.unused_between_frames.count);
  return in(scratch);
}

void SecondLookState::stop(FrameBudget& budget) {
  if (steps_left == 0) return;
  steps_left = 0;
  budget.second_look = {};
}

namespace {

constexpr const SecondLookTuning& kTuning = kSecondLookTuning;

/// How many looks an alignment of this frame counts for that is better than the start; 0: it is not.
int count_better(TrackerParts& t, const AlignedFace& face, Span<const Vec2> landmarks) {
  const SecondLookState& look = *face_detection_of(t).look;
  const float e = face.landmark_error, of_start = look.start_error, of_track = t.result.landmark_error;
  const bool tells_shape = is_frontal(view_of(face.pose, face.camera));
  const bool tells_more_than_start = tells_shape && look.began_turned;
  if (face.score < kTuning.least_score || distance_from_track(t, landmarks) < kTuning.least_distance ||
      e > of_start || (e > of_track && !tells_more_than_start))
    return 0;
  const float ratio = e / max(of_start, of_track);
  if (tells_more_than_start || (ratio <= kTuning.sure_error_ratio && (tells_shape || look.began_turned)))
    return kTuning.looks;
  return tells_shape && ratio <= kTuning.most_error_ratio ? 1 : 0;
}

/// Moves the offsets to the mean of the landmarks of the start and of the looks so far, this one included. Alignments of one face
/// differ, with its expression most of all.
void average_landmarks(TrackerParts& t, const AlignedFace& face, Span<const Vec2> landmarks) {
  SecondLookState& look = *face_detection_of(t).look;
  if (!t.keeps_landmark_offsets || face.score < kTuning.least_score ||
      camera_direction(view_of(face.pose, face.camera)).z < kTuning.least_average_frontal ||
      face.landmark_error > min(kTuning.most_average_error, kTuning.most_average_ratio * look.start_error))
    return;
  const float gain =
      max(kTuning.least_gain, 1 / (kTuning.looks_of_start + static_cast<float>(++look.averaged)));
  const Span<const Landmark> all = t.model().landmarks();
  for (std::size_t k = 0; k < all.count; ++k) {
    Vec2 x;
    if (is_ibug_landmark(all[k].name) && t.offsets.project(k, t.estimator, &x))
      t.offsets.place(all[k].uv(), x + gain * (landmarks[k] - x), t.estimator);
  }
}

SecondLookState* lay_out(Arena& arena, const Model& model, const TrackerLimits& limits) {
  return create_part<SecondLookState>(arena, model, limits);
}

/// The rest of a start that was spread: what needs a picture, or all templates.
void settle(TrackerParts& t, const FrameView& frame) {
  FaceDetectionState& detection = face_detection_of(t);
  detection.look->is_captured = false;
  detection.parts = detection.look->readers;
  calibrate_parts(t, frame);
  detection.poor_start.begin(t.templates.count_first(t.limits.patches), t.limits.patches, frame, t.estimator);
}

void begin_track(TrackerParts& t) {
  FaceDetectionState& detection = face_detection_of(t);
  SecondLookState& look = *detection.look;
  if (detection.parts != nullptr) look.readers = detection.parts;
  detection.parts = t.first_templates > 0 ? nullptr : look.readers;
  look.is_captured = false;
  if (!detection.person.is_known) {
    look.start_error = detection.landmark_error;
    look.began_turned = !is_frontal(t.estimator.view());
    look.averaged = 0;
  }
  look.wait = look.frames_left = kTuning.first_wait;
  look.steps_left = look.agreed = look.realigned = 0;
  look.suspected = {};
}

/// From a frontal pose and the mean face: the track, which may be wrong, tells no more than where the face is, and its roll.
void begin_look(TrackerParts& t, const FrameView& frame) {
  FaceDetectionState& detection = face_detection_of(t);
  SecondLookState& look = *detection.look;
  const bool is_doubtful = look.began_turned || look.start_error > kTuning.doubtful_error;
  const std::uint32_t longest = is_doubtful ? kTuning.longest_doubtful_wait : kTuning.longest_wait;
  look.wait = 2 * look.wait < longest ? 2 * look.wait : longest;
  look.frames_left = look.wait;
  const Status status =
      look.modules->begin(look.in_scratch_of(t), frame, box_of_track(t), t.estimator.camera(),
                          {nullptr, roll_of_track(t)}, detection.face_search.room().q, &look.steps_left);
  if (status == Status::ok)
    t.budget.second_look.hurry(kTuning.step_work);
  else
    look.steps_left = 0;
}

bool conclude(TrackerParts& t, const FrameView& frame) {
  if (t.progress.bad_frames > 0) return realign(t, frame);
  FaceDetectionState& detection = face_detection_of(t);
  SecondLookState& look = *detection.look;
  look.realigned = 0;
  look.suspected = {};
  if (look.is_captured) settle(t, frame);
  if (look.start_error == 0 || !is_free(t)) {
    look.stop(t.budget);  // the caller may have placed landmarks in the middle of it
    return false;
  }
  if (look.frames_left > 0) --look.frames_left;
  if (look.steps_left == 0) {
    if (look.frames_left == 0) begin_look(t, frame);
    return false;
  }
  if (!t.budget.take(t.budget.second_look, kTuning.step_work)) return false;
  const AlignmentRoom room = detection.face_search.room();
  AlignedFace face;
  const Status status = look.modules->advance(look.in_scratch_of(t), frame, 1, &face, room.q, room.landmarks);
  look.steps_left = status == Status::ok ? look.steps_left - 1 : 0;
  if (look.steps_left > 0) {
    t.budget.second_look.hurry(kTuning.step_work);  // the head may turn
    return false;
  }
  const int better = status == Status::ok ? count_better(t, face, room.landmarks) : 0;
  look.agreed = better > 0 ? look.agreed + better : 0;
  if (better > 0) look.frames_left = kTuning.wait_if_better;
  if (look.agreed >= kTuning.looks) return begin_soon(t, frame, {face, false, frame.time_ns});
  if (status == Status::ok && better == 0) average_landmarks(t, face, room.landmarks);
  return false;
}

bool is_over(const TrackerParts& t) {
  return !begins_soon(t) && t.key_frames.is_lasting_cut();
}

bool is_after_cut(const TrackerParts& t) {
  return t.detection->look->realigned == 0 && t.key_frames.shows_another_picture();
}

}  // namespace

const SecondLook kSecondLook{lay_out, alignment_bytes, begin_track, conclude,         resume,
                             is_over, is_after_cut,    align_ahead, move_to_alignment};

}  // namespace pliant
