// A rendered person who is not the neutral one turns the head to 55 degrees on both sides, twice. Who it is, is not known at the
// start. The estimate of the person makes pose and landmarks better, and nothing jumps.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "face_film.hpp"
#include "model_builder.hpp"
#include "pliant/tracker.hpp"
#include "random.hpp"
#include "sanitized.hpp"

namespace turned_head_test {

using namespace pliant;

namespace {

constexpr std::size_t kUnique = 80, kFrames = 2 * kUnique;  // the same frames twice
constexpr std::uint32_t kPeople = kSanitized ? 1 : 8;

/// Another person for each seed, with another texture; once to both sides. The frame after the last one would be the first.
FaceFilm film_of(std::uint32_t seed) {
  return FaceFilm(
      320, 240, kUnique,
      [seed](float s, Pose& pose, auto& q) {
        const float turn = 6.28319f * s * (kUnique - 1) / kUnique;
        pose.q = exp_rotation({0, 0.96f * std::sin(turn), 0});
        Random random(11 + seed);  // who it is: as far from the mean as people are
        for (std::size_t k = 0; k < q.size(); ++k)
          if (baked_face().model.parameters()[k].group == Group::identity)
            q[k] = clamp(random.normal(), -2, 2);
        FaceFilm::set(q, "jawOpen", 0.05f - 0.05f * std::cos(4 * turn));
      },
      0.6f, 64, 160, seed);
}

const FaceFilm& first_film() {
  static const FaceFilm* one = new FaceFilm(film_of(0));
  return *one;
}

struct Result {
  std::vector<float> turn;  // degrees, of the second half
  float landmarks_px = 0;   // mean, summed over films
  std::size_t not_tracking = 0, stepped = 0;
};

void run(const FaceFilm& film, Result& r, const TrackerLimits& limits,
         const std::uint8_t* is_free = nullptr) {
  InArena<Tracker> tracker(baked_face().model, limits);
  TrackerOptions options;
  options.is_free = is_free;
  std::vector<std::string> names;
  for (int l = 0; l < 68; ++l) names.push_back("ibug" + std::to_string(100 + l).substr(1));
  std::vector<NamedPoint> points;
  Random random(3);
  for (const std::string& name : names)
    points.push_back(
        {name.c_str(), film.truth(name, 0) + Vec2{0.5f * random.normal(), 0.5f * random.normal()}});
  StartOptions start;
  start.camera = &film.camera;
  REQUIRE(tracker->start_from_landmarks(film.view(0), {points.data(), points.size()}, start, options) ==
          Status::ok);
  const std::uint16_t depth = baked_face().model.find_parameter("faceDepth");
  float before = tracker->parameters()[depth];
  for (std::size_t n = 1; n < kFrames; ++n) {
    const std::size_t k = n % kUnique;
    FrameView view = film.view(k);
    view.time_ns = static_cast<std::int64_t>(n) * 33'333'333;
    view.sequence = static_cast<std::uint32_t>(n);
    FrameResult result;
    REQUIRE(tracker->update(view, &result) == Status::ok);
    r.not_tracking += result.state != TrackState::tracking;
    const float now = tracker->parameters()[depth];
    r.stepped += now != before;
    before = now;
    if (n < kFrames / 2) continue;
    r.turn.push_back(film.turn_error(result.pose, k));
    for (int l = 17; l < 68; ++l) {
      Vec2 x;
      REQUIRE(tracker->landmark(names[static_cast<std::size_t>(l)].c_str(), &x) == Status::ok);
      r.landmarks_px += length(x - film.truth(names[static_cast<std::size_t>(l)], k)) / (51 * kFrames / 2);
    }
  }
}

float at(std::vector<float> values, float fraction) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(fraction * static_cast<float>(values.size() - 1))];
}

}  // namespace

// Eight people, since the rotations of one move by 20 to 40 % with any change of sampling. Ratios: 0.73 of the median, 0.50 at
// 95 %, 0.82 of landmarks. Each bound was half way to no effect from 0.59, 0.54 and 0.79, with 160 frames that all differ.
TEST_CASE("a head that turns far shows who it is: pose and landmarks get better") {
  Result with, without;
  for (std::uint32_t seed = 0; seed < kPeople; ++seed) {
    const FaceFilm film = seed == 0 ? first_film() : film_of(seed);
    run(film, with, {});
    run(film, without, without_person({}));
  }
  MESSAGE("rotation, median and 95 %: " << at(with.turn, 0.5f) << ", " << at(with.turn, 0.95f) << "; without "
                                        << at(without.turn, 0.5f) << ", " << at(without.turn, 0.95f)
                                        << " degrees; landmarks " << with.landmarks_px / kPeople
                                        << ", without " << without.landmarks_px / kPeople << " px");
  CHECK(with.not_tracking == 0);
  CHECK(with.stepped > 2);
  CHECK(without.stepped == 0);
  if (kSanitized) return;  // one says nothing of the others
  CHECK(at(with.turn, 0.5f) < 0.80f * at(without.turn, 0.5f));
  CHECK(at(with.turn, 0.95f) < 0.77f * at(without.turn, 0.95f));
  CHECK(with.landmarks_px < 0.90f * without.landmarks_px);
}

TEST_CASE("an identity that the caller estimates is left to the caller") {
  const std::vector<std::uint8_t> all(baked_face().model.parameters().count, 1);
  const TrackerLimits limits;
  const FaceFilm& film = first_film();
  Result with, without;
  run(film, with, limits, all.data());
  run(film, without, without_person(limits), all.data());
  CHECK(with.turn == without.turn);
}

}  // namespace turned_head_test
