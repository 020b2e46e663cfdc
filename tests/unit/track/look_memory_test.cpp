// What looks and realignments remember of the frames and tracks before. The head stands still. Detection and alignment are a fake
// that knows the truth.
#include <doctest/doctest.h>

#include "fake_faces.hpp"
#include "model_builder.hpp"
#include "track/realignment.hpp"
#include "track/second_look.hpp"

namespace look_memory_test {

using namespace pliant;

namespace {

constexpr std::size_t kFrames = 80;

/// One picture, again and again.
FaceFilm still_film() {
  static const FaceFilm* one = [] {
    auto* film = new FaceFilm(
        320, 240, 1, [](float, Pose&, auto&) {}, 0.5f);
    film->frames.resize(kFrames, film->frames[0]);
    film->poses.resize(kFrames, film->poses[0]);
    film->parameters.resize(kFrames, film->parameters[0]);
    return film;
  }();
  return *one;
}

void make_negative(FaceFilm& film, std::size_t k) {
  for (std::uint8_t& grey : film.frames[k]) grey = static_cast<std::uint8_t>(255 - grey);
}

/// Light in which no template matches; it is no other picture.
void make_dim(FaceFilm& film, std::size_t k) {
  for (std::uint8_t& grey : film.frames[k]) grey = static_cast<std::uint8_t>(100 + grey / 10);
}

struct Tracked {
  FaceFilm film = still_film();
  FakeFaces fake{film};
  InArena<Tracker> tracker{baked_face().model, limits_with_looks()};
  std::size_t k = 0;

  TrackState next() { return update(tracker.object, film, k++).state; }
  std::size_t used_templates() const {
    std::size_t used = 0;
    Vec2 x;
    for (std::size_t i = 0; i < tracker.object.patch_count(); ++i) used += tracker.object.patch(i, &x);
    return used;
  }
};

}  // namespace

TEST_CASE("looks in the mean of a person's landmarks are no looks in that of another one") {
  Tracked t;
  t.fake.covered_error = 0.02f;
  t.fake.error = 0.0235f;  // it counts for the mean, and is not better
  t.fake.covered_frames = 1;
  float low[2];  // how far below its truth the lower lip is after a track's first look, px
  for (float& px : low) {
    const int end = t.fake.steps + 2 * t.fake.steps_an_alignment;
    while (t.fake.steps < end) t.next();
    Vec2 x;
    REQUIRE(t.tracker->landmark("ibug57", &x) == Status::ok);
    px = x.y - t.film.truth("ibug57", 0).y;
    REQUIRE(t.tracker->start_by_detection() == Status::ok);
    t.fake.covered_frames = t.k + 1;
  }
  CHECK(low[0] == doctest::Approx(double(t.fake.lowered_px) * 2 / 3).epsilon(0.05));
  CHECK(low[1] == doctest::Approx(double(low[0])).epsilon(0.03));
}

TEST_CASE("aligned frames are counted from the last good one on") {
  Tracked t;
  const int most = kRealignmentTuning.most_frames;
  for (int k = 2; k <= 2 * most; ++k)
    if (k != most) make_negative(t.film, static_cast<std::size_t>(k));
  for (int k = 0; k <= 2 * most - 1; ++k) CHECK(t.next() == TrackState::tracking);
  CHECK(t.tracker->track_number() == 1);
}

TEST_CASE("another place where the face may be is forgotten when the templates match again") {
  Tracked t;
  for (int k = 0; k < 3; ++k) t.next();
  make_dim(t.film, 3);
  make_dim(t.film, 5);
  make_dim(t.film, 6);
  const float eyes_px = length(t.film.truth("ibug45", 0) - t.film.truth("ibug36", 0));
  t.film.poses[3].t.x = t.film.poses[5].t.x = t.film.poses[6].t.x = t.film.poses[0].t.x + 3;
  t.fake.refined_too_low_px = 1.5f * kRealignmentTuning.most_disagreement * eyes_px;
  t.fake.held_error = 0.06f;
  t.fake.error = 0.02f;
  CHECK(t.next() == TrackState::degraded);
  CHECK(t.next() == TrackState::tracking);
  CHECK(t.next() == TrackState::degraded);
  CHECK(t.next() == TrackState::tracking);
}

TEST_CASE("a new track takes the rest of its templates from a good frame") {
  std::size_t begin = kFrames;
  for (const bool is_first_bad : {false, true}) {
    Tracked t;
    t.fake.covered_frames = 10;
    if (is_first_bad) make_negative(t.film, begin);
    while (t.tracker->track_number() < 2 && t.k + 6 < kFrames) t.next();
    REQUIRE(t.tracker->track_number() == 2);
    begin = t.k - 1;
    for (int k = 0; k < 4; ++k) t.next();
    CHECK(t.used_templates() > t.tracker->patch_count() / 3);
  }
}

}  // namespace look_memory_test
