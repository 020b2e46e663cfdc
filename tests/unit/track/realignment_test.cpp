// Tracks whose templates fail in frames in which alignment still sees the face. Detection and alignment are a fake that knows the
// truth.
#include "track/realignment.hpp"

#include <doctest/doctest.h>

#include <functional>

#include "bad_frames.hpp"
#include "face/turned_picture.hpp"
#include "model_builder.hpp"
#include "track/second_look.hpp"
#include "track/tracker_sizes.hpp"

namespace realignment_test {

using namespace pliant;
using namespace bad_frames;

namespace {

/// What a tracker that starts by itself makes of a film.
struct Run {
  int tracking = 0;           // frames from kChange on
  int matched = 0;            // of these, with half of the templates
  float error = 0;            // of the landmarks, px, the largest of tracked frames
  std::size_t new_track = 0;  // the first frame from kChange on with so many
};

Run run(Tracker& tracker, const FaceFilm& film, std::size_t begin = 0) {
  Run result;
  for (std::size_t k = begin; k < kFrames; ++k) {
    const FrameResult frame = update(tracker, film, k);
    if (k < kChange) {
      REQUIRE(frame.state == TrackState::tracking);
      continue;
    }
    if (frame.state != TrackState::tracking) continue;
    ++result.tracking;
    result.error = max(result.error, film.landmark_error(tracker, k));
    if (frame.inliers < 60) continue;
    if (result.matched++ == 0) result.new_track = k;
  }
  return result;
}

Run run(const FaceFilm& film, const TrackerLimits& limits = limits_with_looks()) {
  InArena<Tracker> tracker(baked_face().model, limits);
  return run(tracker.object, film);
}

constexpr int kChanged = static_cast<int>(kFrames - kChange);

}  // namespace

TEST_CASE("a face whose templates fail is tracked by alignment, until they match again") {
  const std::size_t back = kChange + 15;
  const FaceFilm film = film_of(back);
  FakeFaces fake(film);
  for (const TrackerLimits& limits : {limits_with_looks(), limits_with_fake()}) {
    const int before = fake.searches;
    const Run aligned = run(film, limits);
    CHECK(aligned.tracking == kChanged);
    CHECK(aligned.error < 0.7f);
    CHECK(fake.searches == before + 1);  // one track: the templates of the start match again
    CHECK(aligned.new_track == back);
    CHECK(aligned.matched == static_cast<int>(kFrames - back));
  }
  fake.blind_from = kChange;
  CHECK(run(film).tracking < kChanged - 3);
}

TEST_CASE(
    "in another picture no templates are searched for where an alignment looks, and they are elsewhere") {
  for (const bool looks : {true, false}) {
    CAPTURE(looks);
    Tracked t(changed_film(), looks ? limits_with_looks() : limits_with_fake());
    CHECK(t.tracker->work().searches > 0);
    CHECK(t.state(kChange) == TrackState::tracking);
    CHECK((t.tracker->work().searches == 0) == looks);
  }
}

TEST_CASE("an alignment that is not surely right leaves a frame bad") {
  const struct {
    std::string what;
    float held_error = 0.02f, score = 0.999f;
    std::size_t blind_from = ~std::size_t{0};
  } kCases[] = {
      {"a large landmark error", kRealignmentTuning.most_error + 0.001f},
      {"hardly a face", 0.02f, kRealignmentTuning.least_score - 0.001f},
      {"nothing there", 0.02f, 0.999f, kChange},
  };
  for (const TrackerLimits& limits : {limits_with_looks(), limits_with_fake()})
    for (const auto& c : kCases) {
      CAPTURE(c.what);
      Tracked t(changed_film(), limits);
      t.fake.held_error = c.held_error;
      t.fake.score = c.score;
      t.fake.blind_from = c.blind_from;
      CHECK(t.state(kChange) == TrackState::degraded);
    }
}

TEST_CASE("without second looks one alignment has to do, near the last good place") {
  for (const float more : {0.9f, 1.1f}) {
    CAPTURE(more);
    Tracked t(dim_film(), limits_with_fake());
    t.fake.refined_too_low_px = more * kRealignmentTuning.most_distance_alone * t.eyes_px;
    const int before = t.fake.alignments, refinements = t.fake.refinements;
    CHECK(t.state(kChange) == (more < 1 ? TrackState::tracking : TrackState::degraded));
    CHECK(t.fake.alignments == before);
    CHECK(t.fake.refinements == refinements + 1);
  }
}

TEST_CASE("an alignment away from the last good place has to be confirmed by one that begins in its box") {
  const FaceFilm& film = changed_film();
  const float eyes = length(film.truth("ibug45", kChange) - film.truth("ibug36", kChange));
  const struct {
    float too_low;  // of the eyes' distance
    int alignments;
    TrackState state;
  } kCases[] = {{0, 0, TrackState::tracking},
                {1.5f * kRealignmentTuning.most_distance, 1, TrackState::tracking},
                {1.5f * kRealignmentTuning.most_disagreement, 1, TrackState::degraded}};
  for (const auto& c : kCases) {
    CAPTURE(c.too_low);
    FakeFaces fake(film);
    InArena<Tracker> tracker(baked_face().model, limits_with_looks());
    for (std::size_t k = 0; k < kChange; ++k) update(tracker.object, film, k);
    const int before = fake.alignments;
    fake.refined_too_low_px = c.too_low * eyes;
    CHECK(update(tracker.object, film, kChange).state == c.state);
    CHECK(fake.alignments == before + c.alignments);
  }
}

/// An alignment from the last place ends elsewhere than the face is.
TEST_CASE(
    "where the mean face comes out elsewhere, surely, and stays in the next frame, it is tracked there; else "
    "it is looked for, since the picture is another one") {
  const float held_error = 0.06f, sure = kRealignmentTuning.sure_error_ratio * held_error;
  const struct {
    std::string what;
    const FaceFilm& film;
    float error, score, restless;  // the last one as a fraction of the box's side
    TrackState state;
    bool is_another;
  } kCases[] = {
      {"the same person", changed_film(), 0.99f * sure, 0.999f, 0, TrackState::tracking, false},
      {"another person", film_of_another(), 0.99f * sure, 0.999f, 0, TrackState::degraded, true},
      {"not surely", changed_film(), 1.01f * sure, 0.999f, 0, TrackState::lost, false},
      {"hardly a face", changed_film(), 0.99f * sure, kRealignmentTuning.least_sure_score - 0.01f, 0,
       TrackState::lost, false},
      {"it does not stay", changed_film(), 0.99f * sure, 0.999f, 1.01f * kRealignmentTuning.most_box_shift,
       TrackState::lost, false},
  };
  for (const auto& c : kCases) {
    CAPTURE(c.what);
    FakeFaces fake(c.film);
    InArena<Tracker> tracker(baked_face().model, limits_with_looks());
    for (std::size_t k = 0; k < kChange; ++k) update(tracker.object, c.film, k);
    const std::uint32_t track = tracker->track_number(), person = tracker->person_number();
    const float eyes = length(c.film.truth("ibug45", kChange) - c.film.truth("ibug36", kChange));
    fake.refined_too_low_px = 1.5f * kRealignmentTuning.most_disagreement * eyes;
    fake.restless_px = c.restless * fake.box(kChange).side;
    fake.held_error = held_error;
    fake.error = c.error;
    fake.score = c.score;
    CHECK(update(tracker.object, c.film, kChange).state == TrackState::degraded);
    CHECK(update(tracker.object, c.film, kChange + 1).state == c.state);
    std::size_t k = kChange + 1;
    if (c.is_another) CHECK(update(tracker.object, c.film, ++k).state == TrackState::tracking);
    CHECK(tracker->track_number() == track + c.is_another);
    CHECK(tracker->person_number() == person + c.is_another);
    if (c.state != TrackState::lost) CHECK(c.film.landmark_error(tracker.object, k) < 0.7f);
  }
}

TEST_CASE(
    "a mean face that comes out elsewhere has to be sure in both frames, alike, and confirmed with the "
    "person") {
  constexpr float kUnsure = kRealignmentTuning.least_sure_score - 0.01f,
                  kBad = kRealignmentTuning.most_error + 0.001f;
  const struct {
    std::string what;
    std::function<void(FakeFaces&)> first, second;  // before either frame
    float size = 1;                                 // of the face in the second frame
    bool is_tracked = false;
  } kCases[] = {
      {"sure", {}, {}, 1, true},
      {"hardly larger", {}, {}, 0.99f * kRealignmentTuning.most_box_ratio, true},
      {"unsure in the first", [](FakeFaces& f) { f.score = kUnsure; },
       [](FakeFaces& f) { f.score = 0.999f; }},
      {"unsure in the second", {}, [](FakeFaces& f) { f.score = kUnsure; }},
      {"bad in the second", {}, [](FakeFaces& f) { f.error = kBad; }},
      {"bad with the person", {}, [](FakeFaces& f) { f.held_error = kBad; }},
      {"larger", {}, {}, 1.01f * kRealignmentTuning.most_box_ratio},
      {"elsewhere with the person", {}, [](FakeFaces& f) { f.restless_px = -2, f.alignments |= 1; }},
  };
  for (const auto& c : kCases) {
    CAPTURE(c.what);
    FaceFilm film = changed_film();
    film.poses[kChange].t.x = film.poses[kChange + 1].t.x = film.poses[kChange - 1].t.x + 3;
    film.poses[kChange + 1].t = (1 / c.size) * film.poses[kChange].t;
    Tracked t(film);
    t.cut();
    if (c.first) c.first(t.fake);
    CHECK(t.state(kChange) == TrackState::degraded);
    if (c.second) c.second(t.fake);
    CHECK(t.state(kChange + 1) == (c.is_tracked ? TrackState::tracking : TrackState::lost));
  }
}

TEST_CASE(
    "a face that has moved is tracked at once where the mean face is there, too, however much surer that "
    "is") {
  FaceFilm film = dim_film();
  Tracked t(film);
  film.poses[kChange].t.x += 0.1f * t.eyes_px * film.poses[kChange].t.z / film.camera.f;
  t.fake.held_error = 0.06f;
  const int before = t.fake.alignments;
  CHECK(t.state(kChange) == TrackState::tracking);
  CHECK(t.fake.alignments == before + 1);
}

TEST_CASE(
    "another place is looked at once: if the face is not there, the next frame begins at the last one "
    "again") {
  Tracked t(dim_film());
  t.cut();
  CHECK(t.state(kChange) == TrackState::degraded);
  t.fake.score = kRealignmentTuning.least_sure_score - 0.01f;
  CHECK(t.state(kChange + 1) == TrackState::degraded);
  t.fake.score = 0.999f;
  CHECK(t.state(kChange + 2) != TrackState::tracking);
  CHECK(t.state(kChange + 3) == TrackState::tracking);
}

TEST_CASE(
    "where another person is, a track begins at their landmarks: at once, if the last picture is not kept") {
  TrackerLimits limits = limits_with_looks();
  limits.keeps_previous = false;
  Tracked t(film_of_another(), limits);
  t.cut();
  CHECK(t.state(kChange) == TrackState::degraded);
  CHECK(t.state(kChange + 1) == TrackState::tracking);
  CHECK(t.tracker->track_number() == 2);
  for (const char* name : {"ibug30", "ibug48", "ibug57"}) {
    Vec2 x;
    REQUIRE(t.tracker->landmark(name, &x) == Status::ok);
    CHECK(length(x - t.film.truth(name, kChange + 1)) < 1);
  }
}

TEST_CASE("where hardly a face is seen no mean face is aligned; else with the roll of the head") {
  const FaceFilm film(
      320, 240, 2,
      [](float, Pose& pose, auto&) {
        pose.q = exp_rotation({0, 0, roll_of_turn(2)});
      },
      0.5f);
  FaceFilm changed = film;
  for (std::uint8_t& grey : changed.frames[1]) grey = static_cast<std::uint8_t>(255 - grey);
  for (const bool is_seen : {true, false}) {
    FakeFaces fake(changed);
    InArena<Tracker> tracker(baked_face().model, limits_with_looks());
    CHECK(update(tracker.object, changed, 0).state == TrackState::tracking);
    fake.held_error = kRealignmentTuning.most_error + 0.001f;
    fake.score = kRealignmentTuning.least_seen_score + (is_seen ? 0.001f : -0.001f);
    const int before = fake.alignments;
    fake.roll = -1;
    update(tracker.object, changed, 1);
    CHECK(fake.alignments == before + is_seen);
    if (is_seen) CHECK(fake.roll == roll_of_turn(2));
  }
}

TEST_CASE("frames in which nothing is seen are counted anew after an aligned one") {
  Tracked t(dim_film());
  for (std::size_t k = kChange; k < kChange + 12; ++k) {
    const bool is_seen = k % 4 == 3;
    t.fake.score = is_seen ? 0.999f : 0.01f;
    CHECK((t.state(k) == TrackState::tracking) == is_seen);
    CHECK(t.tracker->is_started());
  }
}

TEST_CASE("a track that begins anew has the error of the alignment that it begins with") {
  for (const bool is_another : {false, true}) {
    CAPTURE(is_another);
    Tracked t(is_another ? film_of_another() : changed_film());
    t.fake.held_error = 0.03f;
    t.fake.error = 0.045f;
    t.fake.tracked_error = 0.06f;
    std::size_t k = kChange;
    FrameResult result;
    while (t.tracker->track_number() == 1 && k < kFrames) result = update(t.tracker.object, t.film, k++);
    CHECK(result.landmark_error == (is_another ? t.fake.error : t.fake.held_error));
  }
}

TEST_CASE("aligned frames do not count as bad ones: a bad frame after many of them does not end the track") {
  const FaceFilm& film = changed_film();
  FakeFaces fake(film);
  InArena<Tracker> tracker(baked_face().model, limits_with_looks());
  for (std::size_t k = 0; k < kChange + 15; ++k) update(tracker.object, film, k);
  fake.blind_from = kChange + 15;
  CHECK(update(tracker.object, film, kChange + 15).state == TrackState::degraded);
  CHECK(tracker->is_started());
}

TEST_CASE("a track that begins anew as the same person, before that one is known, counts as theirs") {
  FaceFilm film = changed_film();
  for (std::size_t k = 2; k < kChange; ++k)
    for (std::uint8_t& grey : film.frames[k]) grey = static_cast<std::uint8_t>(255 - grey);
  FakeFaces fake(film);
  InArena<Tracker> tracker(baked_face().model, limits_with_looks());
  for (std::size_t k = 0; k < kFrames; ++k) update(tracker.object, film, k);
  CHECK(tracker->track_number() == 2);
  CHECK(tracker->person_number() == 1);
}

TEST_CASE("a track that begins anew as the same person keeps the camera") {
  const FaceFilm& film = changed_film();
  FakeFaces fake(film);
  Camera camera = film.camera;
  camera.k1 = 0.001f;
  camera.cx += 0.125f;
  StartOptions start;
  start.camera = &camera;
  InArena<Tracker> tracker(baked_face().model, limits_with_looks());
  REQUIRE(tracker->start_by_detection(start) == Status::ok);
  CHECK(run(tracker.object, film).new_track > kChange);
  CHECK(tracker->camera().k1 == camera.k1);
  CHECK(tracker->camera().cx == camera.cx);
  CHECK(tracker->camera().f == camera.f);
}

TEST_CASE("where the templates stay away a new track begins, of the same person, and no frame is lost") {
  const FaceFilm& film = changed_film();
  FakeFaces fake(film);
  fake.least_part = kFaceChecksTuning.least_part - 1;  // but who it is was found by a start that saw all
  fake.tracked_error = fake.held_error = 1.1f * kFaceChecksTuning.doubtful_error;
  fake.least_part_from = kChange;
  InArena<Tracker> tracker(baked_face().model, limits_with_looks());
  const Run changed = run(tracker.object, film);
  CHECK(changed.tracking == kChanged);
  // It begins in the next frame with a part of its templates, and has all in the one after that.
  CHECK(changed.new_track == kChange + static_cast<std::size_t>(kRealignmentTuning.most_frames) + 1);
  CHECK(changed.matched == static_cast<int>(kFrames - changed.new_track));
  CHECK(fake.searches == 1);
  float width;
  REQUIRE(tracker->parameter("faceWidth", &width) == Status::ok);
  CHECK(width == kWidth);
}

TEST_CASE("a new track takes its edges once, also with so few templates that it takes them at once") {
  bool had_few = false;
  for (const float contrast : {0.1f, 0.11f, 0.12f}) {
    FaceFilm film = changed_film();
    for (std::size_t k = kChange; k < kFrames; ++k)
      for (std::uint8_t& grey : film.frames[k])
        grey = static_cast<std::uint8_t>(100 + contrast * static_cast<float>(grey));
    FakeFaces fake(film);
    const TrackerLimits limits = limits_with_looks();
    InArena<Tracker> tracker(baked_face().model, limits);
    run(tracker.object, film);
    if (!tracker->is_started()) continue;
    std::size_t used = 0;
    for (std::size_t k = 0; k < tracker->patch_count(); ++k) {
      Vec2 x;
      used += tracker->patch(k, &x);
    }
    had_few = had_few || (tracker->track_number() > 1 && used < 10);
    CHECK(tracker->estimator().predict().count <= used + edge_points(limits));
  }
  CHECK(had_few);
}

TEST_CASE(
    "that track is of another person, if the face has surely become theirs and the caller has not said whose "
    "it is") {
  const FaceFilm& film = film_of_another();
  FakeFaces fake(film);
  InArena<Tracker> tracker(baked_face().model, limits_with_looks());
  bool is_another = false;
  std::size_t begin = 0;
  SUBCASE("surely") {
    is_another = true;
  }
  SUBCASE("perhaps") {
    for (; begin < kChange; ++begin) update(tracker.object, film, begin);
    fake.error = kRealignmentTuning.most_error + 0.001f;  // without a known identity
  }
  SUBCASE("given") {
    begin = 1;
    REQUIRE(film.start_at_truth(tracker.object) == Status::ok);
  }
  run(tracker.object, film, begin);
  float of_other = 0, of_first = 0;
  REQUIRE(tracker->parameter("noseLength", &of_other) == Status::ok);
  REQUIRE(tracker->parameter("faceWidth", &of_first) == Status::ok);
  CHECK(of_other == (is_another ? kWidth : 0));
  CHECK(of_first == (is_another ? 0 : kWidth));
}

TEST_CASE("a head that is turned far is degraded where it is aligned, too") {
  const FaceFilm film = film_of(kFrames, "faceWidth", 0.95f);
  FakeFaces fake(film);
  InArena<Tracker> tracker(baked_face().model, limits_with_looks());
  for (std::size_t k = 0; k < kFrames; ++k) {
    const FrameResult frame = update(tracker.object, film, k);
    CHECK(frame.state == TrackState::degraded);
    CHECK(frame.landmark_error < 0.03f);
  }
}

TEST_CASE("a look that has begun is left for a bad frame, and keeps no other work waiting afterwards") {
  const std::size_t first_look = kSecondLookTuning.first_wait;
  FaceFilm film = film_of(kChange);
  for (std::uint8_t& grey : film.frames[first_look + 2]) grey = static_cast<std::uint8_t>(255 - grey);
  FakeFaces fake(film);
  InArena<Tracker> tracker(baked_face().model, limits_with_looks());
  for (std::size_t k = 0; k < first_look + 2; ++k) update(tracker.object, film, k);
  REQUIRE(fake.alignments == 2);
  CHECK(update(tracker.object, film, first_look + 2).state == TrackState::tracking);
  CHECK(fake.refinements == 1);
  const int steps = fake.steps;
  const int before = fake.verifications;
  for (std::size_t k = first_look + 3; k < first_look + 15; ++k) update(tracker.object, film, k);
  CHECK(fake.refinements == 2);  // the frame after it is aligned, too
  CHECK(fake.steps == steps + fake.steps_an_alignment);
  CHECK(fake.verifications >= before + 2);
}

}  // namespace realignment_test
