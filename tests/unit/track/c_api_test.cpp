// The C interface, used as C would: what it refuses, and that each start leads to the same face.
#include <doctest/doctest.h>

#include <cstring>
#include <string>
#include <vector>

#include "baked_face.hpp"
#include "pliant/pliant.h"
#include "pliant/status.hpp"
#include "renderer.hpp"

using namespace pliant;

namespace {

constexpr int kWidth = 320, kHeight = 240;

/// One picture of the built-in face, what is known about it, and a block of memory.
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
    block.resize(PLIANT_SCRATCH_BYTES + 16);
    REQUIRE(pliant_required_bytes(memory(), PLIANT_SCRATCH_BYTES, table(), table_bytes(), &limits, &bytes) ==
            PLIANT_OK);
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
  pliant_frame frame(int k) const {
    return {pixels.data(), kWidth, k * 33'333'333LL, kWidth, kHeight, 1, static_cast<std::uint32_t>(k)};
  }
};

Rig& rig() {
  static Rig one;
  return one;
}

void check_follows(pliant_tracker* t, float most_px) {
  const pliant_frame next = rig().frame(1);
  pliant_result result;
  REQUIRE(pliant_update(t, &next, &result) == PLIANT_OK);
  CHECK(result.state == PLIANT_TRACKING);
  for (const char* name : {"nose_tip", "eye_left", "mouth_right"}) {
    float x, y;
    REQUIRE(pliant_get_landmark(t, name, &x, &y) == PLIANT_OK);
    Vec2 truth;
    REQUIRE(Projector(view_of(rig().pose, rig().camera), true)
                .project(rig().face.at(name, rig().face.rest()), &truth));
    CHECK(length(truth - Vec2{x, y}) < most_px);
  }
}

}  // namespace

TEST_CASE("versions of headers, library and text are one") {
  const Version v = version();
  CHECK(v.major == PLIANT_VERSION_MAJOR);
  CHECK(pliant_version() ==
        std::to_string(v.major) + "." + std::to_string(v.minor) + "." + std::to_string(v.patch));
}

TEST_CASE("status numbers and texts are those of C++, and any number has a text") {
  CHECK(pliant_status_text(PLIANT_NOT_STARTED) == std::string(text(Status::not_started)));
  CHECK(pliant_status_text(PLIANT_TOO_FEW_POINTS) == std::string(text(Status::too_few_points)));
  for (int k : {-1, 200, 255, 256, 100000}) CHECK(pliant_status_text(k) == std::string("unknown status"));
}

TEST_CASE("memory: just enough will do, a byte less or a crooked address will not") {
  pliant_tracker* t = nullptr;
  Rig& r = rig();
  CHECK(pliant_create(r.memory(), r.bytes - 1, r.table(), r.table_bytes(), &r.limits, &t) ==
        PLIANT_OUT_OF_MEMORY);
  CHECK(pliant_create(r.memory() + 8, r.bytes, r.table(), r.table_bytes(), &r.limits, &t) ==
        PLIANT_BAD_ARGUMENT);
  CHECK(pliant_create(nullptr, r.bytes, r.table(), r.table_bytes(), &r.limits, &t) == PLIANT_BAD_ARGUMENT);
  CHECK(pliant_create(r.memory(), r.bytes, r.table(), r.table_bytes(), nullptr, &t) == PLIANT_BAD_ARGUMENT);
  CHECK(pliant_create(r.memory(), r.bytes, r.table(), 100, &r.limits, &t) == PLIANT_TRUNCATED);
  const auto* odd = static_cast<const unsigned char*>(r.table()) + 1;
  CHECK(pliant_create(r.memory(), r.bytes, odd, r.table_bytes() - 1, &r.limits, &t) == PLIANT_MISALIGNED);
  CHECK(t == nullptr);
  CHECK(r.bytes <= 250 * 1024);
}

TEST_CASE("limits that nothing can be made for are refused") {
  size_t bytes = 7;
  alignas(16) unsigned char scratch[PLIANT_SCRATCH_BYTES];
  const auto ask = [&](const pliant_limits& l) {
    return pliant_required_bytes(scratch, sizeof scratch, rig().table(), rig().table_bytes(), &l, &bytes);
  };
  CHECK(ask(pliant_profile('X')) == PLIANT_BAD_ARGUMENT);
  pliant_limits l = pliant_profile('S');
  l.region_width = 400;
  CHECK(ask(l) == PLIANT_BAD_ARGUMENT);
  l = pliant_profile('S');
  l.start_points = 3;
  CHECK(ask(l) == PLIANT_BAD_ARGUMENT);
  l = pliant_profile('S');
  CHECK(pliant_required_bytes(scratch, sizeof scratch - 1, rig().table(), rig().table_bytes(), &l, &bytes) ==
        PLIANT_OUT_OF_MEMORY);
  CHECK(pliant_required_bytes(nullptr, sizeof scratch, rig().table(), rig().table_bytes(), &l, &bytes) ==
        PLIANT_BAD_ARGUMENT);
  CHECK(bytes == 7);
  CHECK(ask(pliant_profile('L')) == PLIANT_OK);
  CHECK(bytes > rig().bytes);
}

TEST_CASE("a start from landmarks, from a box and from a pose each follow the face") {
  pliant_tracker* t = rig().create();
  const pliant_frame first = rig().frame(0);
  REQUIRE(pliant_start_points(t, &first, 0, rig().points.data(), rig().points.size()) == PLIANT_OK);
  check_follows(t, 1);
  const pliant_camera camera{rig().camera.f, rig().camera.cx, rig().camera.cy};
  const Pose& p = rig().pose;
  const pliant_pose pose{{p.q.w, p.q.x, p.q.y, p.q.z}, {p.t.x, p.t.y, p.t.z}};
  REQUIRE(pliant_start_pose(t, &first, &camera, &pose, nullptr) == PLIANT_OK);
  check_follows(t, 1);
  float x0 = 1e9f, x1 = 0, y0 = 1e9f, y1 = 0;
  for (const pliant_point& q : rig().points) {
    x0 = min(x0, q.x);
    x1 = max(x1, q.x);
    y0 = min(y0, q.y);
    y1 = max(y1, q.y);
  }
  REQUIRE(pliant_start_box(t, &first, camera.f, x0, y0, x1 - x0, y1 - y0) == PLIANT_OK);
  check_follows(t, 6);
}

TEST_CASE("landmarks given beside the model's are told of where they were given, until another start") {
  pliant_tracker* t = rig().create();
  const pliant_frame first = rig().frame(0), next = rig().frame(1);
  const auto place = [t](const char* name) {
    Vec2 x;
    REQUIRE(pliant_get_landmark(t, name, &x.x, &x.y) == PLIANT_OK);
    return x;
  };
  // Up and down by turns, all over the face: no person, pose or expression of the model is like that.
  std::vector<pliant_point> points(rig().points.begin() + 17, rig().points.begin() + 60);
  for (size_t k = 0; k < points.size(); ++k) points[k].y += k % 2 == 0 ? 5.0f : -5.0f;
  REQUIRE(pliant_start_points(t, &first, 0, points.data(), points.size()) == PLIANT_OK);
  const auto error = [&] {
    float sum = 0;
    for (const pliant_point& p : points) sum += length(place(p.landmark) - Vec2{p.x, p.y});
    return sum / static_cast<float>(points.size());
  };
  CHECK(error() < 1);
  pliant_result result;
  REQUIRE(pliant_update(t, &next, &result) == PLIANT_OK);
  CHECK(result.state == PLIANT_TRACKING);
  CHECK(error() < 2);
  const pliant_camera camera{rig().camera.f, rig().camera.cx, rig().camera.cy};
  const Pose& p = rig().pose;
  const pliant_pose pose{{p.q.w, p.q.x, p.q.y, p.q.z}, {p.t.x, p.t.y, p.t.z}};
  REQUIRE(pliant_start_pose(t, &first, &camera, &pose, nullptr) == PLIANT_OK);
  for (size_t k = 17; k < 60; ++k)
    CHECK(length(place(rig().points[k].landmark) - Vec2{rig().points[k].x, rig().points[k].y}) < 0.01f);
}

TEST_CASE("what is asked before a start, or asked wrongly, has a status") {
  pliant_tracker* t = rig().create();
  const pliant_frame first = rig().frame(0);
  pliant_result result;
  float x, y;
  size_t index;
  CHECK(pliant_update(t, &first, &result) == PLIANT_NOT_STARTED);
  CHECK(pliant_get_result(t, &result) == PLIANT_NOT_STARTED);
  CHECK(pliant_get_parameters(t, nullptr, nullptr) == PLIANT_NOT_STARTED);
  CHECK(pliant_get_landmark(t, "nose_tip", &x, &y) == PLIANT_NOT_STARTED);
  CHECK(pliant_find_parameter(t, "no such thing", &index) == PLIANT_NOT_FOUND);
  CHECK(pliant_find_parameter(t, "jawOpen", &index) == PLIANT_OK);
  std::vector<pliant_point> points = rig().points;
  const auto start = [&](size_t count) { return pliant_start_points(t, &first, 0, points.data(), count); };
  CHECK(start(3) == PLIANT_TOO_FEW_POINTS);
  points.resize(69, points[0]);
  CHECK(start(69) == PLIANT_CAPACITY);
  points[2].landmark = "third eye";
  CHECK(start(68) == PLIANT_NOT_FOUND);
  points[2].landmark = nullptr;
  CHECK(start(68) == PLIANT_NOT_FOUND);
  points.assign(8, rig().points[0]);
  CHECK(start(8) == PLIANT_UNDERDETERMINED);
  CHECK(pliant_update(t, &first, &result) == PLIANT_NOT_STARTED);
  REQUIRE(pliant_start_points(t, &first, 448, rig().points.data(), 68) == PLIANT_OK);
  points.assign(8, rig().points[0]);
  points[7].landmark = "third eye";
  CHECK(start(8) == PLIANT_NOT_FOUND);  // what was started goes on
  CHECK(pliant_update(t, &first, &result) == PLIANT_STALE_FRAME);
  CHECK(pliant_update(t, nullptr, &result) == PLIANT_BAD_ARGUMENT);
  CHECK(pliant_update(nullptr, &first, &result) == PLIANT_BAD_ARGUMENT);
  CHECK(pliant_get_landmark(t, "third eye", &x, &y) == PLIANT_NOT_FOUND);
  pliant_frame wrong = rig().frame(1);
  wrong.width = 319;
  CHECK(pliant_update(t, &wrong, &result) == PLIANT_SIZE_MISMATCH);
}
