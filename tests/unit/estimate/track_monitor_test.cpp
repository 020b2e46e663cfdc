#include "estimate/track_monitor.hpp"

#include <doctest/doctest.h>

namespace track_monitor_test {

using namespace pliant;

namespace {

SolveResult good_result() {
  SolveResult r;
  r.rows = r.inliers = 40;
  r.searched = 50;
  r.patches_searched = 30;
  r.patch_inliers = 25;
  r.rms_px = 1;
  r.score = 0.9f;
  r.pose_is_observed = true;
  return r;
}

bool is_good(void (*change)(SolveResult&), float scale_ratio = 1, int width = 320) {
  TrackMonitor monitor;
  monitor.start(width);
  SolveResult r = good_result();
  change(r);
  return monitor.is_good(r, scale_ratio);
}

}  // namespace

TEST_CASE("each rule alone makes a frame bad") {
  CHECK(is_good([](SolveResult&) {}));
  CHECK_FALSE(is_good([](SolveResult& r) { r.inliers = 7; }));
  CHECK_FALSE(is_good([](SolveResult& r) { r.searched = 300; }));
  CHECK_FALSE(is_good([](SolveResult& r) { r.patch_inliers = 4; }));
  CHECK_FALSE(is_good([](SolveResult& r) { r.rms_px = 4.1f; }));
  CHECK_FALSE(is_good([](SolveResult& r) { r.score = 0.4f; }));
  CHECK_FALSE(is_good([](SolveResult& r) { r.pose_is_observed = false; }));
  CHECK_FALSE(is_good([](SolveResult&) {}, 1.21f));
  CHECK_FALSE(is_good([](SolveResult&) {}, 1 / 1.21f));
}

TEST_CASE("residuals may grow with the image; a result without scores is judged by the rest") {
  CHECK(is_good([](SolveResult& r) { r.rms_px = 7.9f; }, 1, 640));
  CHECK(is_good([](SolveResult& r) { r.score = 0; }));
}

TEST_CASE("three bad frames in a row lose the track, one good frame restores it") {
  TrackMonitor monitor;
  monitor.start(320);
  CHECK(monitor.add(false) == TrackState::degraded);
  CHECK(monitor.add(true) == TrackState::tracking);
  CHECK(monitor.add(false) == TrackState::degraded);
  CHECK(monitor.add(false) == TrackState::degraded);
  for (int k = 0; k < 3; ++k) {
    CHECK(monitor.add(false) == TrackState::lost);
    CHECK(monitor.bad_frames() == 3);
  }
  CHECK(monitor.add(true) == TrackState::tracking);
  CHECK(monitor.bad_frames() == 0);
}

TEST_CASE("a result at the bounds of all rules is good") {
  const TrackMonitorTuning& t = kTrackMonitorTuning;
  CHECK(is_good(
      [](SolveResult& r) { r.inliers = static_cast<std::uint16_t>(kTrackMonitorTuning.least_inliers); }));
  CHECK(is_good([](SolveResult& r) { r.rms_px = kTrackMonitorTuning.most_rms_px; }));
  CHECK(is_good([](SolveResult& r) { r.score = kTrackMonitorTuning.least_score; }));
  CHECK(is_good([](SolveResult&) {}, 1 + t.most_scale_change));
  CHECK(is_good([](SolveResult&) {}, 1.0001f / (1 + t.most_scale_change)));
}

}  // namespace track_monitor_test
