#pragma once
// A face to track through the C interface: one image of it, what is known about it, and a block of memory.
#include <doctest/doctest.h>

#include <limits>
#include <string>
#include <vector>

#include "aligned_block.hpp"
#include "baked_face.hpp"
#include "pliant/pliant.h"
#include "pliant/tracker.hpp"
#include "renderer.hpp"

namespace c_rig {

using namespace pliant;

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
  AlignedBlock block;
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
    block = AlignedBlock(bytes);
  }
  const void* table() const { return face.words.data(); }
  size_t table_bytes() const { return face.model.table_bytes(); }
  unsigned char* memory() { return block.data(); }
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

inline Rig& rig() {
  static Rig one;
  return one;
}

inline Vec2 landmark(pliant_tracker* t, const char* name) {
  Vec2 x;
  REQUIRE(pliant_get_landmark(t, name, &x.x, &x.y) == PLIANT_OK);
  return x;
}

inline void check_tracks(pliant_tracker* t, float most_px) {
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

/// The status of an update with frame number `frame`.
inline pliant_status next_update(pliant_tracker* t, int frame) {
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

}  // namespace c_rig
