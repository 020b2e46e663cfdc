// The C interface: every status of every function, what changes nothing, and that each start leads to the same face.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "baked_face.hpp"
#include "pliant/pliant.h"
#include "pliant/tracker.hpp"
#include "renderer.hpp"

using namespace pliant;

namespace {

constexpr int kWidth = 320, kHeight = 240;
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// One image of the built-in face, what is known about it, and a block of memory.
struct Rig {
  BakedModel& face = baked_face();
  Camera camera = centred_camera(kWidth, kHeight, 448);
  Pose pose;
  std::vector<std::uint8_t> pixels;
  std::vector<pliant_point> points;
  std::vector<std::string> names;
  pliant_limits limits = pliant_profile('S');
  std::vector<unsigned char> block;
  size_t bytes = 0;

  Rig() {
    const std::vector<float> rest = face.rest();
    pose = frontal_pose(face.cascade, rest.data(), camera, kHeight, 0.7f);
    const Picture backdrop = make_backdrop(kWidth, kHeight, 5);
    pixels = Renderer(face.cascade).draw(rest.data(), pose, camera, backdrop).pixels;
    for (int k = 0; k < 68; ++k)
      names.push_back(std::string("ibug") + (k < 10 ? "0" : "") + std::to_string(k));
    for (const std::string& name : names) {
      Vec2 x;
      REQUIRE(Projector(view_of(pose, camera), true).project(face.at(name, rest), &x));
      points.push_back({name.c_str(), x.x, x.y});
    }
    REQUIRE(pliant_required_bytes(table(), table_bytes(), &limits, &bytes) == PLIANT_OK);
    block.resize(bytes + 32);
  }
  const void* table() const { return face.words.data(); }
  size_t table_bytes() const { return face.model.table_bytes(); }
  unsigned char* memory() {
    return block.data() + (16 - reinterpret_cast<std::uintptr_t>(block.data()) % 16) % 16;
  }
  pliant_tracker* create() {
    pliant_tracker* tracker = nullptr;
    REQUIRE(pliant_create(memory(), bytes, table(), table_bytes(), &limits, &tracker) == PLIANT_OK);
    return tracker;
  }
  pliant_tracker* start() {
    pliant_tracker* tracker = create();
    const pliant_frame first = frame(0);
    REQUIRE(pliant_start_from_landmarks(tracker, &first, points.data(), points.size(), nullptr) == PLIANT_OK);
    return tracker;
  }
  pliant_frame frame(int k) const {
    return {pixels.data(), kWidth, k * 33'333'333LL, kWidth, kHeight, 1, static_cast<std::uint32_t>(k)};
  }
  pliant_camera c_camera() const { return {camera.f, camera.cx, camera.cy, 0, 0, 0}; }
  pliant_pose c_pose() const {
    return {{pose.q.w, pose.q.x, pose.q.y, pose.q.z}, {pose.t.x, pose.t.y, pose.t.z}};
  }
};

Rig& rig() {
  static Rig one;
  return one;
}

Vec2 landmark(pliant_tracker* t, const char* name) {
  Vec2 x;
  REQUIRE(pliant_get_landmark(t, name, &x.x, &x.y) == PLIANT_OK);
  return x;
}

void check_tracks(pliant_tracker* t, float most_px) {
  const pliant_frame next = rig().frame(1);
  pliant_result result;
  REQUIRE(pliant_update(t, &next, &result) == PLIANT_OK);
  CHECK(result.state == PLIANT_TRACKING);
  for (const char* name : {"nose_tip", "eye_left", "mouth_right"}) {
    Vec2 truth;
    REQUIRE(Projector(view_of(rig().pose, rig().camera), true)
                .project(rig().face.at(name, rig().face.rest()), &truth));
    CHECK(length(truth - landmark(t, name)) < most_px);
  }
}

/// The status of the next update, which must not have been stale: whether a tracker still tracks.
pliant_status next_update(pliant_tracker* t, int frame) {
  const pliant_frame next = rig().frame(frame);
  pliant_result result;
  return pliant_update(t, &next, &result);
}

/// Arrays for a state of the built-in face.
struct StateRoom {
  std::vector<float> parameters, offsets;
  pliant_state state;
  StateRoom()
      : parameters(rig().face.model.parameters().count),
        offsets(3 * rig().face.model.landmarks().count),
        state{parameters.data(), offsets.data(), parameters.size(), offsets.size() / 3, {}, {}} {}
};

}  // namespace

TEST_CASE("the version of the headers is that of the library and of its text") {
  const Version v = version();
  CHECK(v.major == PLIANT_VERSION_MAJOR);
  CHECK(pliant_version() ==
        std::to_string(v.major) + "." + std::to_string(v.minor) + "." + std::to_string(v.patch));
}

TEST_CASE("status numbers and texts are those of C++, and any number has a text") {
  CHECK(pliant_status_text(PLIANT_NOT_STARTED) == std::string(text(Status::not_started)));
  CHECK(pliant_status_text(PLIANT_TOO_FEW_POINTS) == std::string(text(Status::too_few_points)));
  CHECK(pliant_status_text(PLIANT_DEGENERATE_DATA) == std::string(text(Status::degenerate_data)));
  CHECK(pliant_status_text(PLIANT_CAMERA_LOST) == std::string(text(Status::camera_lost)));
  for (int k = PLIANT_OK; k <= PLIANT_STALE_FRAME; ++k)
    CHECK(pliant_status_text(k) != std::string("unknown status"));
  for (int k : {-1, PLIANT_STALE_FRAME + 1, 200, 255, 256, 100000})
    CHECK(pliant_status_text(k) == std::string("unknown status"));
}

TEST_CASE("profiles are those of C++; another name gives limits that are refused") {
  const TrackerLimits own[] = {profile_s(), profile_m(), profile_l()};
  for (int k = 0; k < 3; ++k) {
    const pliant_limits l = pliant_profile("SML"[k]);
    CHECK(l.profile == "SML"[k]);
    CHECK(l.width == own[k].width);
    CHECK(l.region_width == own[k].region_width);
    CHECK(l.patches == own[k].patches);
    CHECK(l.key_patches == own[k].key_patches);
    CHECK(l.vertices == own[k].vertices);
    CHECK(l.start_points == own[k].start_points);
  }
  const pliant_limits none = pliant_profile('X'), zero = {};
  CHECK(std::memcmp(&none, &zero, sizeof none) == 0);
}

TEST_CASE("memory: just enough will do, a byte less or a crooked address will not") {
  pliant_tracker* t = nullptr;
  Rig& r = rig();
  const auto create = [&](void* memory, size_t bytes, const pliant_limits* limits) {
    return pliant_create(memory, bytes, r.table(), r.table_bytes(), limits, &t);
  };
  for (const size_t bytes : {size_t{0}, size_t{64}, r.bytes / 2, r.bytes - 1})
    CHECK(create(r.memory(), bytes, &r.limits) == PLIANT_OUT_OF_MEMORY);
  CHECK(create(r.memory() + 8, r.bytes, &r.limits) == PLIANT_BAD_ARGUMENT);
  CHECK(create(nullptr, r.bytes, &r.limits) == PLIANT_BAD_ARGUMENT);
  CHECK(create(r.memory(), r.bytes, nullptr) == PLIANT_BAD_ARGUMENT);
  CHECK(t == nullptr);
  CHECK(pliant_create(r.memory(), r.bytes, r.table(), r.table_bytes(), &r.limits, nullptr) ==
        PLIANT_BAD_ARGUMENT);
  CHECK(create(r.memory(), r.bytes, &r.limits) == PLIANT_OK);
  CHECK(r.bytes <= 250 * 1024);
}

TEST_CASE("faults of the table: each has its status, of creating and of asking for the size") {
  Rig& r = rig();
  const auto check = [&](const void* table, size_t table_bytes, pliant_status expected) {
    pliant_tracker* t = nullptr;
    size_t bytes = 7;
    CHECK(pliant_create(r.memory(), r.bytes, table, table_bytes, &r.limits, &t) == expected);
    CHECK(pliant_required_bytes(table, table_bytes, &r.limits, &bytes) == expected);
    CHECK(t == nullptr);
    CHECK(bytes == 7);
  };
  check(nullptr, r.table_bytes(), PLIANT_BAD_ARGUMENT);
  check(r.table(), 100, PLIANT_TRUNCATED);
  check(static_cast<const unsigned char*>(r.table()) + 1, r.table_bytes() - 1, PLIANT_MISALIGNED);
  check(r.face.words.data() + 1, r.table_bytes() - 4, PLIANT_BAD_MAGIC);
  auto words = r.face.words;
  words[1] += 1;
  check(words.data(), r.table_bytes(), PLIANT_BAD_VERSION);
  words = r.face.words;
  words[words.size() / 2] ^= 1;
  check(words.data(), r.table_bytes(), PLIANT_BAD_CHECKSUM);
  words = r.face.words;
  std::memset(words.data() + 4, 0x7f, 64);  // the first sections, with the right sum
  words[3] = crc32(words.data() + 4, r.table_bytes() - 16);
  check(words.data(), r.table_bytes(), PLIANT_BAD_TABLE);
}

TEST_CASE("limits that no tracker can be made for are refused") {
  size_t bytes = 7;
  const auto ask = [&](const pliant_limits& l) {
    return pliant_required_bytes(rig().table(), rig().table_bytes(), &l, &bytes);
  };
  const auto refused = [&](auto&& change) {
    pliant_limits l = pliant_profile('S');
    change(l);
    return ask(l) == PLIANT_BAD_ARGUMENT;
  };
  CHECK(ask(pliant_profile('X')) == PLIANT_BAD_ARGUMENT);
  CHECK(refused([](pliant_limits& l) { l.profile = 's'; }));
  CHECK(refused([](pliant_limits& l) { l.width = 63; }));
  CHECK(refused([](pliant_limits& l) { l.height = 0; }));
  CHECK(refused([](pliant_limits& l) { l.region_width = 400; }));
  CHECK(refused([](pliant_limits& l) { l.region_height = 0; }));
  CHECK(refused([](pliant_limits& l) { l.patches = 5; }));
  CHECK(refused([](pliant_limits& l) { l.patches = l.key_patches = 0x8000; }));
  CHECK(refused([](pliant_limits& l) { l.start_points = 3; }));
  const pliant_limits l = pliant_profile('S');
  CHECK(pliant_required_bytes(rig().table(), rig().table_bytes(), nullptr, &bytes) == PLIANT_BAD_ARGUMENT);
  CHECK(pliant_required_bytes(rig().table(), rig().table_bytes(), &l, nullptr) == PLIANT_BAD_ARGUMENT);
  CHECK(bytes == 7);
  CHECK(ask(pliant_profile('M')) == PLIANT_OK);
  const size_t medium = bytes;
  CHECK(ask(pliant_profile('L')) == PLIANT_OK);
  CHECK(rig().bytes < medium);
  CHECK(medium < bytes);
  pliant_limits without = pliant_profile('S');
  without.start_points = 0;
  CHECK(ask(without) == PLIANT_OK);
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
  float x0 = 1e9f, x1 = 0, y0 = 1e9f, y1 = 0;
  for (const pliant_point& q : rig().points) {
    x0 = min(x0, q.x);
    x1 = max(x1, q.x);
    y0 = min(y0, q.y);
    y1 = max(y1, q.y);
  }
  const pliant_start_options options{nullptr, camera.f, 0};
  REQUIRE(pliant_start_from_box(t, &first, x0, y0, x1 - x0, y1 - y0, &options) == PLIANT_OK);
  check_tracks(t, 6);
  REQUIRE(pliant_start_from_state(t, &first, &room.state) == PLIANT_OK);
  check_tracks(t, 1);
}

TEST_CASE("what is known of a start is used: focal length, camera, lens") {
  pliant_tracker* t = rig().create();
  const pliant_frame first = rig().frame(0);
  pliant_result result;
  const auto start = [&](const pliant_start_options& options) {
    REQUIRE(pliant_start_from_landmarks(t, &first, rig().points.data(), 68, &options) == PLIANT_OK);
    REQUIRE(pliant_get_result(t, &result) == PLIANT_OK);
    return result.camera;
  };
  CHECK(start({nullptr, 500, 0}).f == doctest::Approx(500));
  CHECK(result.camera.aspect == 1);
  const pliant_camera camera{460, 150, 120, 0.02f, 0, 1.01f};
  const pliant_camera used = start({&camera, 500, 0});
  CHECK(std::memcmp(&used, &camera, sizeof used) == 0);
}

TEST_CASE("a saved state brings back parameters, pose and landmarks") {
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
  CHECK(error() < 2);
  const pliant_start_options without{nullptr, 0, 1};
  REQUIRE(pliant_start_from_landmarks(t, &first, points.data(), points.size(), &without) == PLIANT_OK);
  CHECK(error() > 2);
  const pliant_camera camera = rig().c_camera();
  const pliant_pose pose = rig().c_pose();
  REQUIRE(pliant_start_from_pose(t, &first, &camera, &pose, nullptr) == PLIANT_OK);
  for (size_t k = 17; k < 60; ++k)
    CHECK(length(landmark(t, rig().points[k].landmark) - Vec2{rig().points[k].x, rig().points[k].y}) < 0.01f);
  REQUIRE(pliant_place_landmarks(t, points.data(), points.size()) == PLIANT_OK);
  CHECK(error() < 0.01f);
}

TEST_CASE("all names can be listed before a start, and each of them can be read after it") {
  pliant_tracker* t = rig().create();
  size_t parameters = 0, landmarks = 0;
  REQUIRE(pliant_parameter_count(t, &parameters) == PLIANT_OK);
  REQUIRE(pliant_landmark_count(t, &landmarks) == PLIANT_OK);
  CHECK(parameters == rig().face.model.parameters().count);
  CHECK(landmarks == rig().face.model.landmarks().count);
  const pliant_frame first = rig().frame(0);
  REQUIRE(pliant_start_from_landmarks(t, &first, rig().points.data(), 68, nullptr) == PLIANT_OK);
  const float* values = nullptr;
  REQUIRE(pliant_get_parameters(t, &values) == PLIANT_OK);
  const char* name = nullptr;
  for (size_t k = 0; k < parameters; ++k) {
    REQUIRE(pliant_parameter_name(t, k, &name) == PLIANT_OK);
    CHECK(name == std::string(rig().face.model.parameters()[k].name));
    float value = -1;
    REQUIRE(pliant_get_parameter(t, name, &value) == PLIANT_OK);
    CHECK(value == values[k]);
  }
  for (size_t k = 0; k < landmarks; ++k) {
    REQUIRE(pliant_landmark_name(t, k, &name) == PLIANT_OK);
    CHECK(name == std::string(rig().face.model.landmarks()[k].name));
    Vec2 by_index;
    REQUIRE(pliant_get_landmark_at(t, k, &by_index.x, &by_index.y) == PLIANT_OK);
    CHECK(length(landmark(t, name) - by_index) == 0);
  }
  CHECK(pliant_parameter_name(t, parameters, &name) == PLIANT_NOT_FOUND);
  CHECK(pliant_landmark_name(t, landmarks, &name) == PLIANT_NOT_FOUND);
}

TEST_CASE("before a start everything that needs one says so") {
  pliant_tracker* t = rig().create();
  StateRoom room;
  pliant_result result;
  float x;
  const float* values = nullptr;
  CHECK(next_update(t, 0) == PLIANT_NOT_STARTED);
  CHECK(pliant_get_result(t, &result) == PLIANT_NOT_STARTED);
  CHECK(pliant_save(t, &room.state) == PLIANT_NOT_STARTED);
  CHECK(pliant_get_parameter(t, "jawOpen", &x) == PLIANT_NOT_STARTED);
  CHECK(pliant_get_parameters(t, &values) == PLIANT_NOT_STARTED);
  CHECK(pliant_get_landmark(t, "nose_tip", &x, &x) == PLIANT_NOT_STARTED);
  CHECK(pliant_get_landmark_at(t, 0, &x, &x) == PLIANT_NOT_STARTED);
  CHECK(pliant_place_landmarks(t, rig().points.data(), 1) == PLIANT_NOT_STARTED);
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
  const pliant_start_options odd{nullptr, -1, 0};
  CHECK(pliant_start_from_landmarks(t, &first, points.data(), 68, &odd) == PLIANT_BAD_ARGUMENT);
  CHECK(pliant_start_from_box(t, &first, 80, 50, 100, 100, &odd) == PLIANT_BAD_ARGUMENT);
  CHECK(pliant_start_from_box(t, &first, 80, 50, 0, 100, nullptr) == PLIANT_BAD_ARGUMENT);
  CHECK(landmarks(3) == PLIANT_TOO_FEW_POINTS);
  points.resize(69, points[0]);
  CHECK(landmarks(69) == PLIANT_CAPACITY);
  for (const char* name : {"third eye", static_cast<const char*>(nullptr)}) {
    points[2].landmark = name;
    CHECK(landmarks(68) == PLIANT_NOT_FOUND);
  }
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

TEST_CASE(
    "updates and questions that are wrong have a status, write nothing, and leave the track as it was") {
  pliant_tracker* t = rig().start();
  const pliant_frame first = rig().frame(0), next = rig().frame(1);
  pliant_result result;
  std::memset(&result, 0x5a, sizeof result);
  const pliant_result untouched = result;
  CHECK(pliant_update(t, &first, &result) == PLIANT_STALE_FRAME);
  CHECK(pliant_update(t, nullptr, &result) == PLIANT_BAD_ARGUMENT);
  CHECK(pliant_update(t, &next, nullptr) == PLIANT_BAD_ARGUMENT);
  CHECK(pliant_update(nullptr, &next, &result) == PLIANT_BAD_ARGUMENT);
  pliant_frame wrong = next;
  wrong.width = 319;
  CHECK(pliant_update(t, &wrong, &result) == PLIANT_SIZE_MISMATCH);
  wrong = next;
  wrong.pixel_step_bytes = 2;  // profile S reads planar frames only
  wrong.stride_bytes = 2 * kWidth;
  CHECK(pliant_update(t, &wrong, &result) == PLIANT_BAD_ARGUMENT);
  CHECK(pliant_get_result(nullptr, &result) == PLIANT_BAD_ARGUMENT);
  CHECK(pliant_get_result(t, nullptr) == PLIANT_BAD_ARGUMENT);
  CHECK(std::memcmp(&result, &untouched, sizeof result) == 0);

  float x = 7, y = 7;
  size_t count = 7;
  const char* name = nullptr;
  const float* values = nullptr;
  CHECK(pliant_get_landmark(t, "third eye", &x, &y) == PLIANT_NOT_FOUND);
  CHECK(pliant_get_landmark_at(t, 1000, &x, &y) == PLIANT_NOT_FOUND);
  CHECK(pliant_get_parameter(t, "third eye", &x) == PLIANT_NOT_FOUND);
  const pliant_point unknown{"third eye", 1, 2}, not_finite{"nose_tip", kNaN, 2};
  CHECK(pliant_place_landmarks(t, &unknown, 1) == PLIANT_NOT_FOUND);
  CHECK(pliant_place_landmarks(t, &not_finite, 1) == PLIANT_BAD_ARGUMENT);
  for (const pliant_status status : {pliant_get_landmark(nullptr, "nose_tip", &x, &y),
                                     pliant_get_landmark(t, nullptr, &x, &y),
                                     pliant_get_landmark(t, "nose_tip", nullptr, &y),
                                     pliant_get_landmark(t, "nose_tip", &x, nullptr),
                                     pliant_get_landmark_at(nullptr, 0, &x, &y),
                                     pliant_get_landmark_at(t, 0, nullptr, &y),
                                     pliant_get_landmark_at(t, 0, &x, nullptr),
                                     pliant_get_parameter(nullptr, "jawOpen", &x),
                                     pliant_get_parameter(t, nullptr, &x),
                                     pliant_get_parameter(t, "jawOpen", nullptr),
                                     pliant_get_parameters(nullptr, &values),
                                     pliant_get_parameters(t, nullptr),
                                     pliant_parameter_count(nullptr, &count),
                                     pliant_parameter_count(t, nullptr),
                                     pliant_landmark_count(nullptr, &count),
                                     pliant_landmark_count(t, nullptr),
                                     pliant_parameter_name(nullptr, 0, &name),
                                     pliant_parameter_name(t, 0, nullptr),
                                     pliant_landmark_name(nullptr, 0, &name),
                                     pliant_landmark_name(t, 0, nullptr),
                                     pliant_place_landmarks(nullptr, &unknown, 1),
                                     pliant_place_landmarks(t, nullptr, 1),
                                     pliant_save(nullptr, nullptr),
                                     pliant_save(t, nullptr)})
    CHECK(status == PLIANT_BAD_ARGUMENT);
  CHECK(x == 7);
  CHECK(y == 7);
  CHECK(count == 7);
  CHECK(name == nullptr);
  CHECK(values == nullptr);
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
