#pragma once
/// \file face_detection_state.hpp
/// What a tracker of faces keeps for starts of its own and for the verification of its tracks.
#include "face/part_fit.hpp"
#include "track/detection_state.hpp"
#include "track/face_checks.hpp"
#include "track/face_search.hpp"
#include "track/poor_start.hpp"

namespace pliant {

/// What a tracker of faces keeps: search, checks, poor starts, the person, the readers of the eyes.
struct FaceDetectionState : DetectionState {
  FaceSearch face_search;
  FaceChecks checks;
  PoorStart poor_start;
  KnownPerson person;
  PartPoints* parts = nullptr;      // null: the model has no readers
  std::int64_t last_read_ns = 0;    // time of the frame that was read last, or of the start
  float landmark_error = 0;         // of the last start, as the alignment estimates it; 0: unknown

  void lay_out(Arena& arena, const Model& model, const TrackerLimits& limits);
  /// The person of a track that was confirmed is known from then on, seen by this camera.
  void note_person(const Camera& camera) {
    if (!person.is_known) person.is_known = checks.has_confirmed() && !poor_start.is_poor();
    person.camera = camera;
  }
  /// Begins a track with this frame where an alignment during a track, which held nothing, has the face: of somebody new.
  void begin_anew(TrackerParts& tracker, const FrameView& frame, const AlignedFace& face);
  /// The same of the same person, where the track is: its templates are given up.
  void renew(TrackerParts& tracker, const FrameView& frame, float error);
  /// Begins the caller's track where an alignment has it, with parameters q: the same track, of the same person.
  void resume_at(TrackerParts& tracker, const FrameView& frame, const AlignedFace& face, const float* q);
};

}  // namespace pliant
