#pragma once
// The face box of a track. Inline, since a program for a microcontroller has one call of it.
#include "face/ibug_landmarks.hpp"
#include "track/tracker_parts.hpp"

namespace pliant {

/// Of the track, as its parameters have it; side 0 if the model has no such landmarks.
inline FaceBox box_of_track(TrackerParts& t) {
  const auto place = [&](std::uint16_t k, Vec2* x) { return t.offsets.project(k, t.estimator, x); };
  return box_at_landmarks(t.model(), t.estimator.view().s, place);
}

}  // namespace pliant
