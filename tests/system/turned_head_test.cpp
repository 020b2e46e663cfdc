// A rendered person who is not the neutral one turns the head to 55 degrees on both sides, twice. Who it is, is not known at the
// start. The estimate of the person makes pose and landmarks better, and nothing jumps.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "face_film.hpp"
#include "model_builder.hpp"
#include "pliant/tracker.hpp"
#include "random.hpp"

using namespace pliant;

namespace {

constexpr std::size_t kFrames = 160;

const FaceFilm& film() {
  static const FaceFilm* one = new FaceFilm(
      320, 240, kFrames,
      [](float s, Pose& pose, auto& q) {
        pose.q = exp_rotation({0, 0.96f * std::sin(12.5664f * s), 0});
        Random random(11);  // who it is: as far from the mean as people are
        for (std::size_t k = 0; k < q.size(); ++k)
          if (baked_face().model.parameters()[k].group == Group::identity)
            q[k] = clamp(random.normal(), -2, 2);
        FaceFilm::set(q, "jawOpen", 0.05f - 0.05f * std::cos(50 * s));
      },
      0.6f);
  return *one;
}

struct Result {
  std::vector<float> turn;  // degrees, of the second half, ascending
  float landmarks_px = 0, largest_step = 0;
  std::size_t not_tracking = 0, stepped = 0;
};

Result run(const TrackerLimits& limits, const std::uint8_t* is_free = nullptr) {
  InArena<Tracker> tracker(baked_face().model, limits);
  TrackerOptions options;
  options.is_free = is_free;
  std::vector<std::string> names;
  for (int l = 0; l < 68; ++l) names.push_back("ibug" + std::to_string(100 + l).substr(1));
  std::vector<NamedPoint> points;
  Random random(3);
  for (const std::string& name : names)
    points.push_back(
        {name.c_str(), film().truth(name, 0) + Vec2{0.5f * random.normal(), 0.5f * random.normal()}});
  StartOptions start;
  start.camera = &film().camera;
  REQUIRE(tracker->start_from_landmarks(film().view(0), {points.data(), points.size()}, start, options) ==
          Status::ok);
  Result r;
  const std::uint16_t depth = baked_face().model.find_parameter("faceDepth");
  float before = tracker->parameters()[depth];
  for (std::size_t k = 1; k < kFrames; ++k) {
    FrameResult result;
    REQUIRE(tracker->update(film().view(k), &result) == Status::ok);
    r.not_tracking += result.state != TrackState::tracking;
    const float now = tracker->parameters()[depth];
    r.stepped += now != before;
    r.largest_step = std::max(r.largest_step, magnitude(now - before));
    before = now;
    if (k < kFrames / 2) continue;
    r.turn.push_back(film().turn_error(result.pose, k));
    for (int l = 17; l < 68; ++l) {
      Vec2 x;
      REQUIRE(tracker->landmark(names[static_cast<std::size_t>(l)].c_str(), &x) == Status::ok);
      r.landmarks_px += length(x - film().truth(names[static_cast<std::size_t>(l)], k)) / (51 * kFrames / 2);
    }
  }
  std::sort(r.turn.begin(), r.turn.end());
  return r;
}

float at(const std::vector<float>& ascending, float fraction) {
  return ascending[static_cast<std::size_t>(fraction * static_cast<float>(ascending.size() - 1))];
}

}  // namespace

TEST_CASE("a head that turns far shows who it is: pose and landmarks get better") {
  const Result with = run({}), without = run(without_person({}));
  MESSAGE("rotation, median and 95 %: " << at(with.turn, 0.5f) << ", " << at(with.turn, 0.95f) << "; without "
                                        << at(without.turn, 0.5f) << ", " << at(without.turn, 0.95f)
                                        << " degrees; landmarks " << with.landmarks_px << ", without "
                                        << without.landmarks_px << " px");
  CHECK(with.not_tracking == 0);
  CHECK(with.stepped > 2);
  CHECK(without.stepped == 0);
  CHECK(at(with.turn, 0.5f) < 0.75f * at(without.turn, 0.5f));
  CHECK(at(with.turn, 0.95f) < 0.85f * at(without.turn, 0.95f));
  CHECK(with.landmarks_px < without.landmarks_px);
}

TEST_CASE("an identity that the caller estimates is left to the caller") {
  const std::vector<std::uint8_t> all(baked_face().model.parameters().count, 1);
  const TrackerLimits limits;
  const Result with = run(limits, all.data()), without = run(without_person(limits), all.data());
  CHECK(with.turn == without.turn);
}
