// The starts of a tracker: from landmarks, a box and a saved state, and what it tells by name.
#include <doctest/doctest.h>

#include <cstring>
#include <limits>

#include "face_film.hpp"
#include "host/commands/image_fit.hpp"
#include "model_builder.hpp"
#include "pliant/tracker.hpp"

namespace tracker_start_test {

using namespace pliant;

namespace {

constexpr int kWidth = 320, kHeight = 240;

const FaceFilm& film() {
  static const FaceFilm* one = new FaceFilm(kWidth, kHeight, 6, [](float s, Pose& pose, auto& q) {
    pose.q = exp_rotation({0.02f * s, 0.1f * s, 0});
    FaceFilm::set(q, "jawOpen", 0.1f * s);
  });
  return *one;
}

/// The 51 inner landmarks of frame 0, up to four pixels beside the model's.
const std::vector<NamedPoint>& points() {
  static const std::vector<NamedPoint>* all = [] {
    auto* out = new std::vector<NamedPoint>;
    for (const Landmark& l : baked_face().model.landmarks()) {
      if (std::strncmp(l.name, "ibug", 4) != 0 || std::strcmp(l.name, "ibug16") <= 0) continue;
      const auto k = static_cast<float>(out->size());
      out->push_back({l.name, film().truth(l.name, 0) +
                                  4.0f * Vec2{static_cast<float>(out->size() % 3) - 1, 0.04f * k - 1}});
    }
    return out;
  }();
  return *all;
}

Span<const NamedPoint> all_points() {
  return {points().data(), points().size()};
}

bool same_bits(const FrameResult& a, const FrameResult& b) {
  return std::memcmp(&a.pose, &b.pose, sizeof a.pose) == 0 && a.inliers == b.inliers && a.rms_px == b.rms_px;
}

Status update(Tracker& tracker, std::size_t k) {
  FrameResult result;
  return tracker.update(film().view(k), &result);
}

}  // namespace

TEST_CASE("a start from landmarks gives the bits of the command's fit of the same points") {
  const host::ModelFile file(baked_face_path());
  std::vector<host::NamedPoint> named;
  for (const NamedPoint& p : points()) named.push_back({p.name, p.x, "points"});
  host::FitSetup setup;
  setup.size = {kWidth, kHeight};
  const host::FitFile fit = host::fit_to_points(file, "points", named, setup);
  std::vector<float> q;
  for (const auto& [name, value] : fit.parameters) q.push_back(value);

  InArena<Tracker> ours(file.model(), TrackerLimits{}), commands(file.model(), TrackerLimits{});
  REQUIRE(ours->start_from_landmarks(film().view(0), all_points()) == Status::ok);
  REQUIRE(commands->start_from_pose(film().view(0), fit.camera, fit.pose, q.data()) == Status::ok);
  const Span<const Landmark> landmarks = file.model().landmarks();
  const std::vector<host::NamedPoint> person = host::person_landmarks(file.model(), fit);
  std::vector<NamedPoint> personal;
  for (const host::NamedPoint& p : person) personal.push_back({p.name.c_str(), p.x});
  REQUIRE(personal.size() > 20);
  REQUIRE(commands->place_landmarks({personal.data(), personal.size()}) == Status::ok);
  CHECK(ours->camera().f == fit.camera.f);
  for (std::size_t k = 1; k < film().count(); ++k) {
    REQUIRE(update(ours.object, k) == Status::ok);
    REQUIRE(update(commands.object, k) == Status::ok);
    CHECK(same_bits(ours->result(), commands->result()));
    for (std::size_t l = 0; l < landmarks.count; ++l) {
      Vec2 a, b;
      REQUIRE(ours->landmark(l, &a) == Status::ok);
      REQUIRE(commands->landmark(landmarks[l].name, &b) == Status::ok);
      CHECK(length(a - b) == 0);
    }
  }
}

TEST_CASE("landmarks given in the start are told where they were given, unless offsets are not wanted") {
  InArena<Tracker> tracker(baked_face().model, TrackerLimits{});
  float error[2] = {};
  for (const bool keeps : {true, false}) {
    TrackerOptions options;
    options.keeps_landmark_offsets = keeps;
    REQUIRE(tracker->start_from_landmarks(film().view(0), all_points(), {}, options) == Status::ok);
    for (const NamedPoint& p : points()) {
      Vec2 x;
      REQUIRE(tracker->landmark(p.name, &x) == Status::ok);
      error[keeps] += length(x - p.x) / static_cast<float>(points().size());
    }
  }
  CHECK(error[true] < 0.5f * error[false]);
}

TEST_CASE("a start after a start, from landmarks again, gives the same bits as the first") {
  InArena<Tracker> tracker(baked_face().model, TrackerLimits{});
  FrameResult results[2];
  for (FrameResult& result : results) {
    REQUIRE(tracker->start_from_landmarks(film().view(0), all_points()) == Status::ok);
    for (std::size_t k = 1; k < film().count(); ++k) REQUIRE(update(tracker.object, k) == Status::ok);
    result = tracker->result();
  }
  CHECK(same_bits(results[0], results[1]));
}

TEST_CASE("a start takes the camera of the track that it ends") {
  Camera bent = film().camera;
  bent.k1 = -0.1f;
  for (const bool is_small : {false, true}) {
    InArena<Tracker> tracker(baked_face().model, is_small ? profile_s() : TrackerLimits{});
    StartOptions known;
    known.camera = &bent;
    REQUIRE(tracker->start_from_landmarks(film().view(0), all_points(), known) == Status::ok);
    const FrameResult first = tracker->result();
    known.camera = &tracker->camera();
    REQUIRE(tracker->start_from_landmarks(film().view(0), all_points(), known) == Status::ok);
    CHECK(same_bits(first, tracker->result()));
    CHECK(tracker->camera().k1 == bent.k1);
    REQUIRE(tracker->start_from_box(film().view(0), {100, 40}, {120, 150}, known) == Status::ok);
    CHECK(tracker->camera().k1 == bent.k1);
  }
}

TEST_CASE("a start from a box puts the face into it, and a known camera or focal length is used") {
  InArena<Tracker> tracker(baked_face().model, TrackerLimits{});
  Vec2 low{1e9f, 1e9f}, high{-1e9f, -1e9f};
  for (const Landmark& l : baked_face().model.landmarks()) {
    if (std::strncmp(l.name, "ibug", 4) != 0) continue;
    const Vec2 x = film().truth(l.name, 0);
    low = min(low, x);
    high = max(high, x);
  }
  REQUIRE(tracker->start_from_box(film().view(0), low, high - low) == Status::ok);
  CHECK(film().landmark_error(tracker.object, 0) < 6);
  CHECK(tracker->camera().f == doctest::Approx(1.4 * kWidth));
  StartOptions known;
  known.focal_px = 500;
  REQUIRE(tracker->start_from_box(film().view(0), low, high - low, known) == Status::ok);
  CHECK(tracker->camera().f == 500);
  known.camera = &film().camera;
  REQUIRE(tracker->start_from_box(film().view(0), low, high - low, known) == Status::ok);
  CHECK(tracker->camera().f == film().camera.f);
  CHECK(update(tracker.object, 1) == Status::ok);
  CHECK(tracker->result().state == TrackState::tracking);
}

TEST_CASE("a saved state starts another tracker at the same pose, parameters and landmarks") {
  const Model& model = baked_face().model;
  InArena<Tracker> first(model, TrackerLimits{}), second(model, TrackerLimits{});
  std::vector<float> q(model.parameters().count);
  std::vector<Vec3> offsets(model.landmarks().count);
  SavedState state{{}, {}, {q.data(), q.size()}, {offsets.data(), offsets.size()}};
  CHECK(first->save(&state) == Status::not_started);
  REQUIRE(first->start_from_landmarks(film().view(0), all_points()) == Status::ok);
  for (std::size_t k = 1; k < film().count(); ++k) REQUIRE(update(first.object, k) == Status::ok);
  CHECK(first->save(nullptr) == Status::bad_argument);
  SavedState small = state;
  small.parameters.count -= 1;
  CHECK(first->save(&small) == Status::bad_argument);
  REQUIRE(first->save(&state) == Status::ok);

  CHECK(second->start_from_state(film().view(5), small) == Status::bad_argument);
  REQUIRE(second->start_from_state(film().view(5), state) == Status::ok);
  CHECK(film().turn_error(second->result().pose, 5) < 2);
  for (std::size_t k = 0; k < model.landmarks().count; ++k) {
    Vec2 a, b;
    REQUIRE(first->landmark(k, &a) == Status::ok);
    REQUIRE(second->landmark(k, &b) == Status::ok);
    CHECK(length(a - b) < 0.01f);
  }
  for (const Parameter& p : model.parameters()) {
    float a, b;
    REQUIRE(first->parameter(p.name, &a) == Status::ok);
    REQUIRE(second->parameter(p.name, &b) == Status::ok);
    CHECK(a == b);
  }
}

TEST_CASE("wrong arguments of a start change nothing; a start that fails later leaves nothing started") {
  InArena<Tracker> tracker(baked_face().model, TrackerLimits{});
  Tracker& t = tracker.object;
  const FrameView frame = film().view(0);
  REQUIRE(t.start_from_landmarks(frame, all_points()) == Status::ok);
  std::vector<NamedPoint> some(points().begin(), points().begin() + 8);
  const auto start = [&](std::size_t count) { return t.start_from_landmarks(frame, {some.data(), count}); };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  CHECK(start(3) == Status::too_few_points);
  some[2].name = "third eye";
  CHECK(start(8) == Status::not_found);
  some[2].name = nullptr;
  CHECK(start(8) == Status::bad_argument);
  for (const float x : {nan, 1e30f, -2e6f}) {
    some[2] = {"ibug30", {x, 0}};
    CHECK(start(8) == Status::bad_argument);
  }
  some.assign(69, points()[0]);
  CHECK(start(69) == Status::capacity);
  StartOptions options;
  for (const float focal : {nan, -1.0f, 1e30f, std::numeric_limits<float>::infinity()}) {
    options.focal_px = focal;
    CHECK(t.start_from_landmarks(frame, all_points(), options) == Status::bad_argument);
    CHECK(t.start_from_box(frame, {10, 10}, {50, 50}, options) == Status::bad_argument);
  }
  CHECK(t.start_from_box(frame, {10, 10}, {0, 20}) == Status::bad_argument);
  CHECK(t.start_from_box({}, {10, 10}, {50, 50}) == Status::bad_argument);
  const Vec2 marker{100, 100};
  CHECK(t.start_from_box(frame, {10, 10}, {50, 50}, {}, {}, {&marker, 1}) == Status::capacity);
  std::vector<float> q(t.parameters().begin(), t.parameters().end());
  q.back() = nan;
  CHECK(t.start_from_pose(frame, film().camera, film().poses[0], q.data()) == Status::bad_argument);
  SavedState state;
  state.camera = film().camera;
  state.pose = film().poses[0];
  state.parameters = {q.data(), q.size()};
  CHECK(t.start_from_state(frame, state) == Status::bad_argument);
  q.back() = 0;
  for (const Vec3& bad : {Vec3{nan, 0, 0}, {0, -1e30f, 0}, {0, 0, 1.001e7f}}) {
    std::vector<Vec3> offsets(baked_face().model.landmarks().count);
    offsets.back() = bad;
    state.landmark_offsets = {offsets.data(), offsets.size()};
    CHECK(t.start_from_state(frame, state) == Status::bad_argument);
  }
  Vec2 x;
  float value;
  CHECK(t.landmark("third eye", &x) == Status::not_found);
  CHECK(t.landmark(1000, &x) == Status::not_found);
  CHECK(t.parameter("third eye", &value) == Status::not_found);
  const NamedPoint wrong{"third eye", {}};
  CHECK(t.place_landmarks({&wrong, 1}) == Status::not_found);
  CHECK(t.is_started());
  CHECK(update(t, 1) == Status::ok);

  some.assign(8, points()[0]);
  CHECK(start(8) == Status::underdetermined);
  CHECK_FALSE(t.is_started());
  CHECK(t.result().state == TrackState::lost);
  CHECK_FALSE(t.result().is_searching);  // there is nothing to search with
  CHECK(update(t, 2) == Status::not_started);
  CHECK(t.landmark("ibug30", &x) == Status::not_started);
  CHECK(t.parameter("jawOpen", &value) == Status::not_started);
  CHECK(t.place_landmarks({}) == Status::not_started);
  REQUIRE(t.start_from_landmarks(frame, all_points()) == Status::ok);
}

}  // namespace tracker_start_test
