#pragma once
// The result of a frame as the C interface has to give it, from the C++ interface.
#include <cstring>

#include "pliant/pliant.h"
#include "pliant/tracker.hpp"

/// Whether all fields of a result are those of a tracker that has seen the same, bit for bit.
inline bool is_result_of(const pliant::Tracker& tracker, const pliant_result& result) {
  const pliant::FrameResult& r = tracker.result();
  const pliant::Camera& c = tracker.camera();
  pliant_result expected;
  std::memset(&expected, 0x5a, sizeof expected);  // a field that is missing below differs
  expected.pose = {{r.pose.q.w, r.pose.q.x, r.pose.q.y, r.pose.q.z}, {r.pose.t.x, r.pose.t.y, r.pose.t.z}};
  expected.camera = {c.f, c.cx, c.cy, c.k1, c.k2, c.aspect};
  expected.rms_px = r.rms_px;
  expected.tracked = r.tracked;
  expected.inliers = r.inliers;
  expected.state = r.state == pliant::TrackState::tracking   ? PLIANT_TRACKING
                   : r.state == pliant::TrackState::degraded ? PLIANT_DEGRADED
                                                             : PLIANT_LOST;
  expected.landmark_error = r.landmark_error;
  expected.is_searching = r.is_searching;
  expected.gaze[0] = r.gaze.x;
  expected.gaze[1] = r.gaze.y;
  expected.gaze[2] = r.gaze.z;
  expected.track = tracker.track_number();
  expected.person = tracker.person_number();
  return std::memcmp(&expected, &result, sizeof result) == 0;  // a result has no padding: 92 bytes of fields
}
