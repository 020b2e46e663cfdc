// The C interface: making a tracker, updates and questions. Every status of every function, and what changes nothing.
#include <doctest/doctest.h>

#include <cstring>
#include <string>
#include <vector>

#include "c_result.hpp"
#include "c_rig.hpp"
#include "model_builder.hpp"

namespace pliant_c_test {

using namespace pliant;
using namespace c_rig;

TEST_CASE("the version of the headers is that of the library and of its text") {
  const Version v = version();
  CHECK(v.major == PLIANT_VERSION_MAJOR);
  CHECK(pliant_version() ==
        std::to_string(v.major) + "." + std::to_string(v.minor) + "." + std::to_string(v.patch));
}

TEST_CASE("status numbers and texts are those of C++, and any number has a text") {
  const auto agree = [](int c, Status cpp) { return pliant_status_text(c) == std::string(text(cpp)); };
  CHECK(agree(PLIANT_TOO_FEW_POINTS, Status::too_few_points));
  CHECK(agree(PLIANT_DEGENERATE_DATA, Status::degenerate_data));
  CHECK(agree(PLIANT_CAMERA_LOST, Status::camera_lost));
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
    CHECK(l.height == own[k].height);
    CHECK(l.region_width == own[k].region_width);
    CHECK(l.region_height == own[k].region_height);
    CHECK(l.patches == own[k].patches);
    CHECK(l.key_patches == own[k].key_patches);
    CHECK(l.vertices == own[k].vertices);
    CHECK(l.start_points == own[k].start_points);
    CHECK(l.smallest_face_px == own[k].smallest_face_px);
    CHECK(l.search_work == own[k].search_work);
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
  CHECK(refused([](pliant_limits& l) { l.region_width = 63; }));
  CHECK(refused([](pliant_limits& l) { l.region_height = 0; }));
  CHECK(refused([](pliant_limits& l) { l.patches = 5; }));
  CHECK(refused([](pliant_limits& l) { l.patches = l.key_patches = 0x8000; }));
  CHECK(refused([](pliant_limits& l) { l.key_patches = 1; }));  // fewer than key frames
  CHECK(refused([](pliant_limits& l) { l.width = 16385; }));
  CHECK(refused([](pliant_limits& l) { l.start_points = 3; }));
  CHECK(refused([](pliant_limits& l) { l.leaves_out = 4; }));
  CHECK(refused([](pliant_limits& l) { l.vertices = 3; }));  // fewer than the base mesh has
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
  // What the header says of templates of key frames.
  for (const char profile : {'S', 'M', 'L'}) {
    pliant_limits few = pliant_profile(profile);
    const std::uint16_t least = profile == 'S' ? 2 : 4;
    few.key_patches = 0;
    CHECK(ask(few) == PLIANT_OK);
    few.key_patches = least;
    CHECK(ask(few) == PLIANT_OK);
    few.key_patches = static_cast<std::uint16_t>(least - 1);
    CHECK(ask(few) == PLIANT_BAD_ARGUMENT);
  }
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
    float least = 7, most = 7;
    REQUIRE(pliant_parameter_range(t, k, &least, &most) == PLIANT_OK);
    CHECK(least == rig().face.model.parameters()[k].minimum);
    CHECK(most == rig().face.model.parameters()[k].maximum);
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
  float least = 7, most = 7;
  CHECK(pliant_parameter_range(t, parameters, &least, &most) == PLIANT_NOT_FOUND);
  CHECK(least == 7);
  CHECK(most == 7);
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

TEST_CASE(
    "every field of a result is that of C++: of starts, of good, bad and lost frames, with a camera of any "
    "kind") {
  pliant_tracker* t = rig().create();
  InArena<Tracker> own(rig().face.model, profile_s());
  pliant_result result;
  const pliant_camera camera{460, 158, 121, 0.02f, 0.01f, 1.01f};
  const Camera same{camera.f, camera.cx, camera.cy, camera.k1, camera.k2, camera.aspect};
  const pliant_pose pose = rig().c_pose();
  const std::vector<std::uint8_t> black(rig().pixels.size());
  bool seen[3] = {};
  for (int k = 0; k < 60; ++k) {
    pliant_frame frame = rig().frame(k);
    if (k > 40) frame.pixels = black.data();
    const FrameView view{frame.pixels, kWidth, kHeight, kWidth, 1, frame.time_ns, frame.sequence};
    CAPTURE(k);
    if (k % 20 == 0) {
      REQUIRE(pliant_start_from_pose(t, &frame, &camera, &pose, nullptr) == PLIANT_OK);
      REQUIRE(own->start_from_pose(view, same, rig().pose, nullptr) == Status::ok);
    } else {
      FrameResult of_own;
      REQUIRE(pliant_update(t, &frame, &result) == PLIANT_OK);
      REQUIRE(own->update(view, &of_own) == Status::ok);
      CHECK(is_result_of(own.object, result));
    }
    REQUIRE(pliant_get_result(t, &result) == PLIANT_OK);
    CHECK(is_result_of(own.object, result));
    seen[result.state] = true;
  }
  CHECK(result.track == 3);
  CHECK(result.person == 3);
  for (const bool state : seen) CHECK(state);
}

TEST_CASE("wrong updates return a status, write nothing, and do not change the track") {
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
  check_tracks(t, 1);
}

TEST_CASE("wrong queries return a status, write nothing, and do not change the track") {
  pliant_tracker* t = rig().start();
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
                                     pliant_parameter_range(nullptr, 0, &x, &y),
                                     pliant_parameter_range(t, 0, nullptr, &y),
                                     pliant_parameter_range(t, 0, &x, nullptr),
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

}  // namespace pliant_c_test
