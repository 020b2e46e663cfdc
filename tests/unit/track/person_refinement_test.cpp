// When the person is estimated: every few frames, in those that have room for it, and never in bad ones.
#include "track/person_refinement.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "estimate/visible_surface.hpp"
#include "face_film.hpp"
#include "model_builder.hpp"
#include "pliant/tracker.hpp"
#include "track/frame_budget.hpp"
#include "track/tracker_sizes.hpp"

namespace person_refinement_test {

using namespace pliant;

namespace {

constexpr std::size_t kFrames = 120;

/// Somebody else than the start says turns the head to 50 degrees on both sides.
const FaceFilm& film() {
  static const FaceFilm* one = new FaceFilm(320, 240, kFrames, [](float s, Pose& pose, auto& q) {
    pose.q = exp_rotation({0, 0.87f * std::sin(6.2832f * s), 0});
    FaceFilm::set(q, "faceDepth", 1.5f);
    FaceFilm::set(q, "noseLength", -1.5f);
  });
  return *one;
}

bool is_identity(std::size_t k) {
  return baked_face().model.parameters()[k].group == Group::identity;
}

/// Frames from one to the next, at least.
std::size_t least_between(const std::vector<std::size_t>& frames) {
  std::size_t least = kFrames;
  for (std::size_t k = 1; k < frames.size(); ++k) least = std::min(least, frames[k] - frames[k - 1]);
  return least;
}

/// Frames in which the identity took a step. Where `is_black(n)`, frame n is black.
template <class IsBlack>
std::vector<std::size_t> steps(IsBlack&& is_black) {
  InArena<Tracker> tracker(baked_face().model, TrackerLimits{});
  REQUIRE(film().start_at_pose(tracker.object) == Status::ok);
  const std::vector<std::uint8_t> black(320 * 240, 0);
  std::vector<std::size_t> found;
  std::vector<float> before(tracker->parameters().begin(), tracker->parameters().end());
  for (std::size_t n = 1; n < kFrames; ++n) {
    FrameView view = film().view(n);
    if (is_black(n)) view.data = black.data();
    FrameResult result;
    REQUIRE(tracker->update(view, &result) == Status::ok);
    bool has_moved = false;
    for (std::size_t k = 0; k < before.size(); ++k) {
      has_moved = has_moved || (is_identity(k) && tracker->parameters()[k] != before[k]);
      before[k] = tracker->parameters()[k];
    }
    if (has_moved) found.push_back(n);
  }
  return found;
}

}  // namespace

TEST_CASE(
    "steps of the identity wait until the head has turned, and have frames between them, which prepare "
    "them") {
  const auto at = steps([](std::size_t) { return false; });
  REQUIRE(at.size() > 3);
  CHECK(film().poses[at.front()].q.y > 0.13f);  // half of 15 degrees
  const std::size_t templates = TrackerLimits{}.patches, most = kPersonRefinementTuning.prepared_templates;
  for (std::size_t k = 1; k < at.size(); ++k) CHECK(at[k] - at[k - 1] > templates / most);
  CHECK(least_between(at) > kVisibleSurfaceTuning.renewal_frames);
  CHECK(at.size() < kFrames / kPersonRefinementTuning.step_frames);
}

TEST_CASE("the pose of a result is that of the state, also in a frame that changes the person") {
  InArena<Tracker> tracker(baked_face().model, TrackerLimits{});
  REQUIRE(film().start_at_pose(tracker.object) == Status::ok);
  const std::uint16_t nose = baked_face().model.find_parameter("noseLength");
  float before = tracker->parameters()[nose];
  std::size_t steps = 0;
  for (std::size_t n = 1; n < kFrames; ++n) {
    CAPTURE(n);
    FrameResult result;
    REQUIRE(tracker->update(film().view(n), &result) == Status::ok);
    const Pose now = pose_of(tracker->estimator().view());
    CHECK(result.pose.q.x == now.q.x);
    CHECK(result.pose.q.y == now.q.y);
    CHECK(result.pose.t.z == now.t.z);
    steps += tracker->parameters()[nose] != before;
    before = tracker->parameters()[nose];
  }
  CHECK(steps > 3);
}

TEST_CASE("wherever a track ends, also within a step, the next one from the same start gives the same bits") {
  const auto start_and_track = [](Tracker& tracker, std::size_t frames) {
    REQUIRE(film().start_at_pose(tracker) == Status::ok);
    FrameResult result;
    for (std::size_t n = 1; n <= frames; ++n) REQUIRE(tracker.update(film().view(n), &result) == Status::ok);
    return result;
  };
  constexpr std::size_t kNext = 44;
  InArena<Tracker> tracker(baked_face().model, TrackerLimits{});
  const FrameResult first = start_and_track(tracker.object, kNext);
  const std::vector<float> q(tracker->parameters().begin(), tracker->parameters().end());
  for (const std::size_t last : {29u, 38u, 56u}) {
    CAPTURE(last);
    start_and_track(tracker.object, last);
    const FrameResult again = start_and_track(tracker.object, kNext);
    CHECK(again.pose.q.y == first.pose.q.y);
    CHECK(again.pose.t.z == first.pose.t.z);
    CHECK(again.rms_px == first.rms_px);
    CHECK(std::equal(q.begin(), q.end(), tracker->parameters().begin()));
  }
}

TEST_CASE("where the frames in which it is due are bad, the estimate waits for the next good ones") {
  // Every fourth frame is black.
  const auto at = steps([](std::size_t n) { return n % 4 == 0; });
  REQUIRE(at.size() > 2);
  for (const std::size_t n : at) CHECK(n % 4 != 0);
}

TEST_CASE("a step that bad frames delay is not soon followed by the next one: the surface follows first") {
  for (const std::size_t last_good : {std::size_t{28}, std::size_t{39}}) {
    CAPTURE(last_good);
    const auto at = steps([=](std::size_t n) { return n % 40 > last_good; });
    REQUIRE(at.size() > 2);
    CHECK(least_between(at) > kVisibleSurfaceTuning.renewal_frames);
  }
}

TEST_CASE("frames that estimate the person, prepare a step or take it stay within their budget") {
  InArena<Tracker> tracker(baked_face().model, TrackerLimits{});
  REQUIRE(film().start_at_pose(tracker.object) == Status::ok);
  const WorkCosts costs = tracker->estimator().work_costs(tracker->limits().patch_window);
  const float most = most_frame_work(tracker->limits(), costs, 0);
  const float last_passes = last_passes_work(tracker->limits(), costs, 0);
  const float step = person_step_work(tracker->model(), tracker->limits());
  const float not_reserved = max(step - kFrameBudgetTuning.most_reserved * most, 0);
  std::size_t rare = 0;
  for (std::size_t n = 1; n < kFrames; ++n) {
    FrameResult result;
    REQUIRE(tracker->update(film().view(n), &result) == Status::ok);
    CAPTURE(n);
    CHECK(costs.of(tracker->work()) <= most + last_passes + not_reserved);
    rare += tracker->work().rare > 0.2f * most;
  }
  CHECK(rare > kFrames / 5);
}

namespace {

/// The parameter at the end of the film. The truth is -1.5; a start by pose begins with 0.
float nose_length_at_the_end(bool places_landmarks) {
  InArena<Tracker> tracker(baked_face().model, TrackerLimits{});
  REQUIRE(film().start_at_pose(tracker.object) == Status::ok);
  for (const Landmark& l : baked_face().model.landmarks()) {
    const NamedPoint point{l.name, film().truth(l.name, 0)};
    if (places_landmarks) REQUIRE(tracker->place_landmarks({&point, 1}) == Status::ok);
  }
  FrameResult result;
  for (std::size_t n = 1; n < kFrames; ++n) REQUIRE(tracker->update(film().view(n), &result) == Status::ok);
  float value = 0;
  REQUIRE(tracker->parameter("noseLength", &value) == Status::ok);
  return value;
}

}  // namespace

TEST_CASE("where the landmarks are seen in frame 0 tells of the person what templates cannot") {
  const float with = nose_length_at_the_end(true), without = nose_length_at_the_end(false);
  CAPTURE(with);
  CAPTURE(without);
  CHECK(std::abs(with + 1.5f) < 0.45f);
  CHECK(std::abs(with + 1.5f) < 0.5f * std::abs(without + 1.5f));
}

TEST_CASE("the smoothed pose turns with a step of the person") {
  InArena<Tracker> tracker(baked_face().model, TrackerLimits{});
  TrackerOptions options;
  options.estimator.smooths = true;
  REQUIRE(film().start_at_pose(tracker.object, 0, options) == Status::ok);
  float before = 0;
  for (std::size_t n = 1; n < kFrames; ++n) {
    FrameResult result;
    REQUIRE(tracker->update(film().view(n), &result) == Status::ok);
    const float lag = length(log_rotation(result.pose.q * conjugate(result.smoothed_pose.q)));
    CAPTURE(n);
    if (n > 5) CHECK(std::abs(lag - before) < 0.015f);  // steps turn by up to twice as much, and the motion begins at once
    before = lag;
  }
}

TEST_CASE("steps of the person give no offsets to who wants the model's landmarks") {
  BakedModel& face = baked_face();
  InArena<Tracker> tracker(face.model, TrackerLimits{});
  const char* const names[] = {"ibug36", "ibug39", "ibug42", "ibug45",
                               "ibug33", "ibug48", "ibug54", "ibug57"};
  std::vector<NamedPoint> points;
  for (const char* name : names) points.push_back({name, film().truth(name, 0)});
  StartOptions start;
  start.camera = &film().camera;
  TrackerOptions options;
  options.keeps_landmark_offsets = false;
  REQUIRE(tracker->start_from_landmarks(film().view(0), {points.data(), points.size()}, start, options) ==
          Status::ok);
  const std::vector<float> before(tracker->parameters().begin(), tracker->parameters().end());
  FrameResult result;
  for (std::size_t n = 1; n < kFrames; ++n) REQUIRE(tracker->update(film().view(n), &result) == Status::ok);
  const std::vector<float> q(tracker->parameters().begin(), tracker->parameters().end());
  bool has_moved = false;
  for (std::size_t k = 0; k < q.size(); ++k) has_moved = has_moved || (is_identity(k) && q[k] != before[k]);
  CHECK(has_moved);
  const Projector projector(tracker->estimator().view(), true);
  for (const char* name : names) {
    CAPTURE(name);
    Vec2 x, of_model;
    REQUIRE(tracker->landmark(name, &x) == Status::ok);
    REQUIRE(projector.project(face.at(name, q), &of_model));
    CHECK(length(x - of_model) < 0.05f);  // the personal field is rounded to 16 bits
  }
}

}  // namespace person_refinement_test
