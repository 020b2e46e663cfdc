#pragma once
// What a tracked frame of a face is worth. Inline, since a program for a microcontroller has one call of it.
#include "pliant/camera.hpp"
#include "track/face_checks.hpp"

namespace pliant {

/// Writes the landmark error of a tracked frame, and what it, the turn of the head and a doubtful start make of the frame's state.
inline void tell_worth(const View& view, float landmark_error, bool is_doubtful, FrameResult* result) {
  result->landmark_error = landmark_error;
  const bool is_turned_away = camera_direction(view).z < kFaceChecksTuning.least_facing;
  if (is_doubtful || is_turned_away || landmark_error > kFaceChecksTuning.most_landmark_error)
    result->state = TrackState::degraded;
}

}  // namespace pliant
