// The starts of the C interface: that each leads to the same face, every status of each, and what a failure leaves.
#include <doctest/doctest.h>

#include <cstring>
#include <string>
#include <vector>

#include "c_rig.hpp"

namespace pliant_c_start_test {

using namespace pliant;
using namespace c_rig;

namespace {

/// Reads in turns with the writes of a caller in C, as a compiler sees it that optimises both together.
[[gnu::noinline]] float read_between(pliant_point* of_caller, const NamedPoint* own) {
  of_caller->x = 1;
  const float first = own->x.x;
  of_caller->x = 5;
  return 10 * first + own->x.x;
}

}  // namespace

TEST_CASE("points that a caller in C has written are read as written, also where both are optimised together") {
  pliant_point point{"nose_tip", 7, 7};
  CHECK(read_between(&point, reinterpret_cast<const NamedPoint*>(&point)) == 15);
}

TEST_CASE("a start from landmarks, from a box, from a pose and from a saved state each track the face") {
  pliant_tracker* t = rig().start();
  const pliant_frame first = rig().frame(0);
  check_tracks(t, 1);
  StateRoom room;
  REQUIRE(pliant_save(t, &room.state) == PLIANT_OK);
  const pliant_camera camera = rig().c_camera();
  const pliant_pose pose = rig().c_pose();
  REQUIRE(pliant_start_from_pose(t, &first, &camera, &pose, nullptr) == PLIANT_OK);
  check_tracks(t, 1);
  Vec2 low{1e9f, 1e9f}, high{};
  for (const pliant_point& q : rig().points) {
    low = min(low, {q.x, q.y});
    high = max(high, {q.x, q.y});
  }
  const pliant_start_options options{nullptr, camera.f, 0, 0};
  REQUIRE(pliant_start_from_box(t, &first, low.x, low.y, high.x - low.x, high.y - low.y, &options) ==
          PLIANT_OK);
  check_tracks(t, 6);
  REQUIRE(pliant_start_from_state(t, &first, &room.state) == PLIANT_OK);
  check_tracks(t, 1);
}

TEST_CASE("the options of a start are used: focal length, camera, lens") {
  pliant_tracker* t = rig().create();
  const pliant_frame first = rig().frame(0);
  pliant_result result;
  const auto start = [&](const pliant_start_options& options) {
    REQUIRE(pliant_start_from_landmarks(t, &first, rig().points.data(), 68, &options) == PLIANT_OK);
    REQUIRE(pliant_get_result(t, &result) == PLIANT_OK);
    return result.camera;
  };
  CHECK(start({nullptr, 500, 0, 0}).f == doctest::Approx(500));
  CHECK(result.camera.aspect == 1);
  const pliant_camera camera{460, 150, 120, 0.02f, 0, 1.01f};
  const pliant_camera used = start({&camera, 500, 0, 0});
  CHECK(std::memcmp(&used, &camera, sizeof used) == 0);
}

TEST_CASE("a saved state restores parameters, pose and landmarks") {
  pliant_tracker* t = rig().start();
  REQUIRE(next_update(t, 1) == PLIANT_OK);
  StateRoom room;
  REQUIRE(pliant_save(t, &room.state) == PLIANT_OK);
  const Vec2 nose = landmark(t, "nose_tip"), chin = landmark(t, "ibug57");
  const float* values = nullptr;
  REQUIRE(pliant_get_parameters(t, &values) == PLIANT_OK);
  CHECK(std::memcmp(values, room.parameters.data(), room.parameters.size() * sizeof(float)) == 0);

  const pliant_frame again = rig().frame(1);
  t = rig().create();
  REQUIRE(pliant_start_from_state(t, &again, &room.state) == PLIANT_OK);
  CHECK(length(landmark(t, "nose_tip") - nose) < 0.01f);
  CHECK(length(landmark(t, "ibug57") - chin) < 0.01f);
  room.state.landmark_count = 0;
  room.state.landmark_offsets = nullptr;
  CHECK(pliant_start_from_state(t, &again, &room.state) == PLIANT_OK);
  CHECK(pliant_save(t, &room.state) == PLIANT_OK);
}

TEST_CASE("landmarks given beside the model's are read where they were given, until another start") {
  pliant_tracker* t = rig().create();
  const pliant_frame first = rig().frame(0);
  // Up and down by turns, all over the face: no person, pose or expression of the model is like that.
  std::vector<pliant_point> points(rig().points.begin() + 17, rig().points.begin() + 60);
  for (size_t k = 0; k < points.size(); ++k) points[k].y += k % 2 == 0 ? 5.0f : -5.0f;
  REQUIRE(pliant_start_from_landmarks(t, &first, points.data(), points.size(), nullptr) == PLIANT_OK);
  const auto error = [&] {
    float sum = 0;
    for (const pliant_point& p : points) sum += length(landmark(t, p.landmark) - Vec2{p.x, p.y});
    return sum / static_cast<float>(points.size());
  };
  CHECK(error() < 1);
  const pliant_frame next = rig().frame(1);
  pliant_result result;
  REQUIRE(pliant_update(t, &next, &result) == PLIANT_OK);
  CHECK(result.state == PLIANT_TRACKING);
  CHECK(result.track == 1);
  CHECK(result.person == 1);
  CHECK(error() < 2);
  const pliant_start_options without{nullptr, 0, 1, 0};
  REQUIRE(pliant_start_from_landmarks(t, &first, points.data(), points.size(), &without) == PLIANT_OK);
  CHECK(error() > 2);
  const pliant_camera camera = rig().c_camera();
  const pliant_pose pose = rig().c_pose();
  REQUIRE(pliant_start_from_pose(t, &first, &camera, &pose, nullptr) == PLIANT_OK);
  REQUIRE(pliant_get_result(t, &result) == PLIANT_OK);
  CHECK(result.track == 3);
  CHECK(result.person == 3);
  for (size_t k = 17; k < 60; ++k)
    CHECK(length(landmark(t, rig().points[k].landmark) - Vec2{rig().points[k].x, rig().points[k].y}) < 0.01f);
  REQUIRE(pliant_place_landmarks(t, points.data(), points.size()) == PLIANT_OK);
  CHECK(error() < 0.01f);
}

TEST_CASE("a start whose pointers, frame, counts or names are wrong changes nothing") {
  pliant_tracker* t = rig().start();
  const pliant_frame first = rig().frame(0);
  const pliant_camera camera = rig().c_camera();
  const pliant_pose pose = rig().c_pose();
  StateRoom room;
  REQUIRE(pliant_save(t, &room.state) == PLIANT_OK);
  std::vector<pliant_point> points = rig().points;
  const auto landmarks = [&](size_t count) {
    return pliant_start_from_landmarks(t, &first, points.data(), count, nullptr);
  };
  // Each start, with a frame and without one.
  const auto starts = [&](const pliant_frame* frame, pliant_status expected) {
    CHECK(pliant_start_from_pose(t, frame, &camera, &pose, nullptr) == expected);
    CHECK(pliant_start_from_landmarks(t, frame, points.data(), 68, nullptr) == expected);
    CHECK(pliant_start_from_box(t, frame, 80, 50, 100, 100, nullptr) == expected);
    CHECK(pliant_start_from_state(t, frame, &room.state) == expected);
  };
  starts(nullptr, PLIANT_BAD_ARGUMENT);
  pliant_frame wrong = first;
  wrong.width = kWidth - 1;
  starts(&wrong, PLIANT_SIZE_MISMATCH);
  wrong = first;
  wrong.stride_bytes = kWidth - 1;
  starts(&wrong, PLIANT_BAD_ARGUMENT);
  wrong = first;
  wrong.pixels = nullptr;
  starts(&wrong, PLIANT_BAD_ARGUMENT);
  CHECK(pliant_start_from_pose(t, &first, nullptr, &pose, nullptr) == PLIANT_BAD_ARGUMENT);
  CHECK(pliant_start_from_pose(t, &first, &camera, nullptr, nullptr) == PLIANT_BAD_ARGUMENT);
  CHECK(pliant_start_from_landmarks(t, &first, nullptr, 68, nullptr) == PLIANT_BAD_ARGUMENT);
  CHECK(pliant_start_from_state(t, &first, nullptr) == PLIANT_BAD_ARGUMENT);
  const pliant_start_options odd{nullptr, -1, 0, 0};
  CHECK(pliant_start_from_landmarks(t, &first, points.data(), 68, &odd) == PLIANT_BAD_ARGUMENT);
  CHECK(pliant_start_from_box(t, &first, 80, 50, 100, 100, &odd) == PLIANT_BAD_ARGUMENT);
  CHECK(pliant_start_from_box(t, &first, 80, 50, 0, 100, nullptr) == PLIANT_BAD_ARGUMENT);
  const pliant_start_options no_convention{nullptr, 0, 0, 3};
  CHECK(pliant_start_from_box(t, &first, 80, 50, 100, 100, &no_convention) == PLIANT_BAD_ARGUMENT);
  CHECK(pliant_start_by_detection(nullptr, nullptr) == PLIANT_BAD_ARGUMENT);
  CHECK(pliant_start_by_detection(t, nullptr) == PLIANT_NOT_FOUND);  // the table has no detector
  CHECK(landmarks(3) == PLIANT_TOO_FEW_POINTS);
  points.resize(69, points[0]);
  CHECK(landmarks(69) == PLIANT_CAPACITY);
  points[2].landmark = "third eye";
  CHECK(landmarks(68) == PLIANT_NOT_FOUND);
  points[2].landmark = nullptr;
  CHECK(landmarks(68) == PLIANT_BAD_ARGUMENT);
  points = rig().points;
  points[2].x = kNaN;
  CHECK(landmarks(68) == PLIANT_BAD_ARGUMENT);
  room.state.parameter_count -= 1;
  CHECK(pliant_start_from_state(t, &first, &room.state) == PLIANT_BAD_ARGUMENT);
  room.state.parameter_count += 1;
  room.state.parameters = nullptr;
  CHECK(pliant_start_from_state(t, &first, &room.state) == PLIANT_BAD_ARGUMENT);
  CHECK(pliant_save(t, &room.state) == PLIANT_BAD_ARGUMENT);
  CHECK(next_update(t, 1) == PLIANT_OK);
}

TEST_CASE("a start that fails later leaves a tracker that is not started, and that can start") {
  pliant_tracker* t = rig().start();
  const pliant_frame first = rig().frame(0);
  std::vector<pliant_point> points(8, rig().points[0]);
  CHECK(pliant_start_from_landmarks(t, &first, points.data(), 8, nullptr) == PLIANT_UNDERDETERMINED);
  CHECK(next_update(t, 1) == PLIANT_NOT_STARTED);
  t = rig().start();
  const pliant_camera camera = rig().c_camera(), no_camera{0, 0, 0, 0, 0, 0};
  const pliant_pose pose = rig().c_pose(), no_pose{{1, 0, 0, 0}, {0, kNaN, 500}};
  CHECK(pliant_start_from_pose(t, &first, &no_camera, &pose, nullptr) == PLIANT_BAD_ARGUMENT);
  CHECK(pliant_start_from_pose(t, &first, &camera, &no_pose, nullptr) == PLIANT_BAD_ARGUMENT);
  CHECK(next_update(t, 1) == PLIANT_NOT_STARTED);
  const std::vector<std::uint8_t> grey(kWidth * kHeight, 128);
  pliant_frame flat = first;
  flat.pixels = grey.data();
  CHECK(pliant_start_from_pose(t, &flat, &camera, &pose, nullptr) == PLIANT_TOO_FEW_POINTS);
  CHECK(pliant_start_from_landmarks(t, &flat, rig().points.data(), 68, nullptr) == PLIANT_TOO_FEW_POINTS);
  CHECK(next_update(t, 1) == PLIANT_NOT_STARTED);
  REQUIRE(pliant_start_from_landmarks(t, &first, rig().points.data(), 68, nullptr) == PLIANT_OK);
  check_tracks(t, 1);
}

TEST_CASE("a landmark behind the camera has no image position") {
  pliant_tracker* t = rig().create();
  const pliant_frame first = rig().frame(0);
  const pliant_camera camera{200, 160, 120, 0, 0, 0};
  const pliant_pose nose_in_the_lens{{1, 0, 0, 0}, {0, 0, 51}};
  REQUIRE(pliant_start_from_pose(t, &first, &camera, &nose_in_the_lens, nullptr) == PLIANT_OK);
  float x = 7, y = 7;
  CHECK(pliant_get_landmark(t, "nose_tip", &x, &y) == PLIANT_UNDERDETERMINED);
  CHECK(x == 7);
}

}  // namespace pliant_c_start_test
