#pragma once
// What a tracker tells, whatever it was fed.
#include <cstdlib>

#include "pliant/tracker.hpp"

namespace fuzz {

inline void require(bool condition) {
  if (!condition) std::abort();
}

inline void check_result(const pliant::Tracker& tracker, const pliant::FrameResult& result) {
  using pliant::TrackState;
  require(result.state <= TrackState::lost && result.landmark_error >= 0 && result.landmark_error <= 1);
  if (!tracker.is_started() || result.state == TrackState::lost) return;
  require(is_finite(result.pose) && pliant::is_finite(result.rms_px));
  for (const float q : tracker.parameters()) require(pliant::is_finite(q));
}

}  // namespace fuzz
