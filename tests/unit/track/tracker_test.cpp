// The whole tracker on rendered pictures of the built-in face, whose pose, expression and landmarks are known.
#include "pliant/tracker.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>

#include "aligned_block.hpp"
#include "face_film.hpp"
#include "heap_trap.hpp"
#include "model_builder.hpp"

namespace tracker_test {

using namespace pliant;

namespace {

constexpr int kWidth = 320, kHeight = 240, kFrames = 24;

BakedModel& face() {
  return baked_face();
}

/// A short film: the head turns and moves, the mouth opens, the brows rise.
const FaceFilm& film() {
  static const FaceFilm* one = new FaceFilm(kWidth, kHeight, kFrames, [](float s, Pose& pose, auto& q) {
    pose.q = exp_rotation({0.08f * s, 0.35f * s, -0.06f * s});
    pose.t = pose.t + Vec3{25 * s, -8 * s, 40 * s};
    FaceFilm::set(q, "jawOpen", 0.25f * (s < 0.5f ? 2 * s : 2 - 2 * s));
    FaceFilm::set(q, "browInnerUpLeft", 0.8f * s);
    FaceFilm::set(q, "browInnerUpRight", 0.8f * s);
  });
  return *one;
}

Status start(Tracker& tracker, Span<const Vec2> markers = {}, TrackerOptions options = {}) {
  return film().start_at_truth(tracker, 0, options, markers);
}

}  // namespace

TEST_CASE("pose, expression and landmarks of a rendered face are followed") {
  InArena<Tracker> tracker(face().model, TrackerLimits{});
  REQUIRE(start(tracker.object) == Status::ok);
  for (std::size_t k = 1; k < kFrames; ++k) {
    FrameResult result;
    REQUIRE(tracker->update(film().view(k), &result) == Status::ok);
    CHECK(result.state == TrackState::tracking);
    CHECK(film().turn_error(result.pose, k) < 2);
    CHECK(film().landmark_error(tracker.object, k) < 1);
  }
  const std::uint16_t brow = face().model.find_parameter("browInnerUpLeft");
  CHECK(tracker->estimator().parameters()[brow] > 0.4f);
}

TEST_CASE("a landmark is told by its index of any integer type, 0 as well, or by its name") {
  InArena<Tracker> tracker(face().model, TrackerLimits{});
  REQUIRE(start(tracker.object) == Status::ok);
  enum Place { first };
  Vec2 by_name, x;
  REQUIRE(tracker->landmark(face().model.landmarks()[0].name, &by_name) == Status::ok);
  const auto is_first = [&](Status status) {
    const bool same = status == Status::ok && x.x == by_name.x && x.y == by_name.y;
    x = {};
    return same;
  };
  CHECK(is_first(tracker->landmark(0, &x)));
  CHECK(is_first(tracker->landmark(0u, &x)));
  CHECK(is_first(tracker->landmark(std::size_t{0}, &x)));
  CHECK(is_first(tracker->landmark(std::uint16_t{0}, &x)));
  CHECK(is_first(tracker->landmark(first, &x)));
  CHECK(tracker->landmark(-1, &x) == Status::not_found);
  CHECK(tracker->landmark(nullptr, &x) == Status::not_found);
}

TEST_CASE("smoothed results begin with frame 0") {
  TrackerOptions options;
  options.estimator.smooths = true;
  InArena<Tracker> tracker(face().model, TrackerLimits{});
  REQUIRE(start(tracker.object, {}, options) == Status::ok);
  const FrameResult& result = tracker->result();
  CHECK(std::memcmp(&result.smoothed_pose, &result.pose, sizeof result.pose) == 0);
  const Pose before = result.smoothed_pose;
  FrameResult next;
  REQUIRE(tracker->update(film().view(1), &next) == Status::ok);
  CHECK(length(next.smoothed_pose.t - before.t) < 5);
  CHECK(length(next.smoothed_pose.t - before.t) > 0);
}

TEST_CASE("smoothed results follow where the clock stands still, and where it creeps") {
  for (const std::int64_t step_ns : {0, 700'000, 33'000'000}) {
    CAPTURE(step_ns);
    TrackerOptions options;
    options.estimator.smooths = true;
    InArena<Tracker> tracker(face().model, TrackerLimits{});
    REQUIRE(start(tracker.object, {}, options) == Status::ok);
    FrameResult result;
    for (int k = 1; k < kFrames; ++k) {
      FrameView view = film().view(static_cast<std::size_t>(k));
      view.time_ns = film().view(0).time_ns + k * step_ns;
      view.sequence = film().view(0).sequence + static_cast<std::uint32_t>(k);
      REQUIRE(tracker->update(view, &result) == Status::ok);
    }
    const Quat first = film().poses[0].q;
    const float moved = length(log_rotation(result.pose.q * conjugate(first))),
                followed = length(log_rotation(result.smoothed_pose.q * conjugate(first)));
    CHECK(followed > 0.8f * moved);
  }
}

TEST_CASE("no heap call is made from the first frame on, in a block of exactly the stated size") {
  const TrackerLimits limits;
  const std::size_t bytes = measured_bytes<Tracker>(face().model, limits);
  AlignedBlock block(bytes);
  Arena arena(block.data(), block.size());
  static Tracker tracker;
  film();
  Status status = Status::ok;
  bool tracked = true;
  {
    const heap_trap::Armed armed;
    status = create_in(arena, tracker, face().model, limits);
    if (status == Status::ok) status = film().start_at_truth(tracker);
    for (std::size_t k = 1; k < kFrames && status == Status::ok; ++k) {
      FrameResult result;
      status = tracker.update(film().view(k), &result);
      tracked = tracked && result.state == TrackState::tracking;
    }
  }
  CHECK(heap_trap::calls == 0);
  CHECK(status == Status::ok);
  CHECK(tracked);
  CHECK(arena.used_bytes() == bytes);
  {
    const heap_trap::Armed armed;          // and the trap does catch one
    ::operator delete(::operator new(4));  // called as functions: a new-expression may be optimised away
  }
  CHECK(heap_trap::calls > 0);
}

TEST_CASE("markers are tracked without templates near them") {
  TrackerLimits limits;
  limits.markers = 3;
  InArena<Tracker> tracker(face().model, limits);
  const char* names[3] = {"ibug30", "ibug48", "ibug19"};
  Vec2 markers[3];
  for (int k = 0; k < 3; ++k) markers[k] = film().truth(names[k], 0);
  TrackerOptions options;
  options.marker_exclusion_px = 10;
  REQUIRE(start(tracker.object, {markers, 3}, options) == Status::ok);
  std::size_t patches = 0;
  for (std::size_t p = 0; p < tracker->patch_count(); ++p) {
    Vec2 x;
    if (!tracker->patch(p, &x)) continue;
    ++patches;
    for (Vec2 m : markers) CHECK(length(x - m) >= 10);
  }
  CHECK(patches > 60);
  FrameResult result;
  for (std::size_t k = 1; k < kFrames; ++k) {
    REQUIRE(tracker->update(film().view(k), &result) == Status::ok);
    for (std::size_t m = 0; m < 3; ++m) {
      Vec2 x;
      REQUIRE(tracker->marker(m, &x));
      CHECK(length(x - film().truth(names[m], k)) < 2.5f);
    }
  }
  Vec2 x;
  CHECK_FALSE(tracker->marker(3, &x));
  // Markers that are no positions are refused before anything is given up.
  markers[1].x = std::numeric_limits<float>::quiet_NaN();
  CHECK(start(tracker.object, {markers, 3}, options) == Status::bad_argument);
  CHECK(start(tracker.object, {nullptr, 3}, options) == Status::bad_argument);
  CHECK(tracker->is_started());
  CHECK(tracker->marker(0, &x));
}

TEST_CASE("a repeated picture moves the state by no more than noise") {
  InArena<Tracker> tracker(face().model, TrackerLimits{});
  REQUIRE(start(tracker.object) == Status::ok);
  FrameResult result;
  FrameView again = film().view(0);
  again.time_ns = film().view(1).time_ns;
  REQUIRE(tracker->update(again, &result) == Status::ok);
  CHECK(length(log_rotation(result.pose.q * conjugate(film().poses[0].q))) < 0.004f);
}

TEST_CASE("black frames lose the face within three, and it is found again when it returns") {
  InArena<Tracker> tracker(face().model, TrackerLimits{});
  REQUIRE(start(tracker.object) == Status::ok);
  const std::vector<std::uint8_t> black(kWidth * kHeight, 0);
  FrameResult result;
  for (int k = 1; k <= 6; ++k) {
    FrameView v = film().view(0);
    v.data = black.data();
    v.time_ns = k * std::int64_t{33'333'333};
    REQUIRE(tracker->update(v, &result) == Status::ok);
    CHECK(result.state == (k < 3 ? TrackState::degraded : TrackState::lost));
  }
  int needed = 0;
  for (; needed < 10 && result.state != TrackState::tracking; ++needed) {
    FrameView v = film().view(2);
    v.sequence = static_cast<std::uint32_t>(7 + needed);
    REQUIRE(tracker->update(v, &result) == Status::ok);
  }
  CHECK(result.state == TrackState::tracking);
  CHECK(length(log_rotation(result.pose.q * conjugate(normalised(film().poses[2].q)))) < 0.05f);
}

TEST_CASE("frames that cannot be used are named and leave everything as it was") {
  InArena<Tracker> tracker(face().model, TrackerLimits{});
  FrameResult result;
  CHECK(tracker->update(film().view(0), &result) == Status::not_started);
  FrameView v = film().view(0);
  v.width = 319;
  CHECK(tracker->start_from_pose(v, film().camera, film().poses[0], film().parameters[0].data()) ==
        Status::size_mismatch);
  v.data = nullptr;
  CHECK(tracker->start_from_pose(v, film().camera, film().poses[0], film().parameters[0].data()) ==
        Status::bad_argument);
  const Vec2 marker{160, 120};
  CHECK(start(tracker.object, {&marker, 1}) == Status::capacity);
  const std::vector<std::uint8_t> grey(kWidth * kHeight, 128);
  v = film().view(0);
  v.data = grey.data();
  CHECK(tracker->start_from_pose(v, film().camera, film().poses[0], film().parameters[0].data()) ==
        Status::too_few_points);
  CHECK(tracker->update(film().view(1), &result) == Status::not_started);

  REQUIRE(start(tracker.object) == Status::ok);
  const Quat before = tracker->estimator().view().q;
  v = film().view(1);
  v.stride_bytes = 100;
  CHECK(tracker->update(v, &result) == Status::bad_argument);
  v.stride_bytes = kWidth;
  v.height = 120;
  CHECK(tracker->update(v, &result) == Status::size_mismatch);
  CHECK(tracker->update(film().view(1), nullptr) == Status::bad_argument);
  CHECK(tracker->estimator().view().q.y == before.y);
  CHECK(tracker->update(film().view(1), &result) == Status::ok);
  CHECK(result.state == TrackState::tracking);
}

TEST_CASE("a frame that comes twice or late is refused; a clock set back or a missing number is not") {
  InArena<Tracker> tracker(face().model, TrackerLimits{});
  REQUIRE(start(tracker.object) == Status::ok);
  FrameResult result;
  REQUIRE(tracker->update(film().view(2), &result) == Status::ok);
  const Quat before = tracker->estimator().view().q;
  CHECK(tracker->update(film().view(2), &result) == Status::stale_frame);
  CHECK(tracker->update(film().view(1), &result) == Status::stale_frame);
  CHECK(tracker->estimator().view().q.y == before.y);
  FrameView v = film().view(3);
  v.time_ns = 5;
  CHECK(tracker->update(v, &result) == Status::ok);
  v.time_ns = 6;
  CHECK(tracker->update(v, &result) == Status::ok);
  v.time_ns = 1;
  v.sequence = 0xffffffffu;  // before 0, and so before 3
  CHECK(tracker->update(v, &result) == Status::stale_frame);
}

TEST_CASE("two trackers on the same frames give the same bits") {
  Quat q[2];
  for (Quat& each : q) {
    InArena<Tracker> tracker(face().model, TrackerLimits{});
    REQUIRE(start(tracker.object) == Status::ok);
    FrameResult result;
    for (std::size_t k = 1; k < 6; ++k) REQUIRE(tracker->update(film().view(k), &result) == Status::ok);
    each = result.pose.q;
  }
  CHECK(q[0].w == q[1].w);
  CHECK(q[0].x == q[1].x);
  CHECK(q[0].y == q[1].y);
  CHECK(q[0].z == q[1].z);
}

TEST_CASE("times may have any origin: the same film later gives the same bits") {
  Pose end[3];
  const std::int64_t origin[] = {0, 500'000'000, 3'600'000'000'000};
  for (int run = 0; run < 3; ++run) {
    InArena<Tracker> tracker(face().model, TrackerLimits{});
    FrameView first = film().view(0);
    first.time_ns += origin[run];
    REQUIRE(tracker->start_from_pose(first, film().camera, film().poses[0], film().parameters[0].data()) ==
            Status::ok);
    FrameResult result;
    for (std::size_t k = 1; k < kFrames; ++k) {
      FrameView view = film().view(k);
      view.time_ns += origin[run];
      REQUIRE(tracker->update(view, &result) == Status::ok);
    }
    end[run] = result.pose;
  }
  for (int run = 1; run < 3; ++run) {
    CHECK(end[run].q.x == end[0].q.x);
    CHECK(end[run].q.y == end[0].q.y);
    CHECK(end[run].t.x == end[0].t.x);
    CHECK(end[run].t.z == end[0].t.z);
  }
}

}  // namespace tracker_test
