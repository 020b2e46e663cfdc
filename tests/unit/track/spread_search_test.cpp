// Starts whose search and alignment are spread over frames, as profile S has them. Detection is a fake that knows the truth.
#include <doctest/doctest.h>

#include "fake_faces.hpp"
#include "model_builder.hpp"

namespace spread_search_test {

using namespace pliant;

namespace {

constexpr std::size_t kFrames = 100;

const FaceFilm& film() {
  static const FaceFilm* one = new FaceFilm(drifting_face(kFrames));
  return *one;
}

TrackerLimits limits_of_search() {
  TrackerLimits limits = limits_with_fake();
  limits.search_work = 3 * kFaceSearchTuning.cells_a_step_alone;
  return limits;
}

}  // namespace

TEST_CASE(
    "a face that was found in a picture without texture is aligned at once in the next ones, not searched "
    "again") {
  FakeFaces fake(film());
  fake.calls_a_search = 6;
  InArena<Tracker> tracker(baked_face().model, limits_of_search());
  const std::vector<std::uint8_t> white(film().frames[0].size(), 255);
  std::size_t k = 0;
  FrameResult result;
  // Until the first alignment has ended in such a picture.
  for (; fake.steps < fake.steps_an_alignment; ++k) {
    FrameView view = film().view(k);
    view.data = white.data();
    REQUIRE(tracker->update(view, &result) == Status::ok);
    CHECK(result.state == TrackState::lost);
  }
  CHECK_FALSE(tracker->is_started());
  const int searches = fake.searches;
  std::size_t frames = 0;
  while (!tracker->is_started()) {
    REQUIRE(++frames < 10);
    result = update(tracker.object, film(), k++);
  }
  CHECK(fake.searches == searches);
  CHECK(fake.alignments == 2);
  CHECK(result.state == TrackState::tracking);
}

TEST_CASE("an alignment whose last step may be in a later frame is scored twice, others once") {
  for (const bool spreads : {false, true}) {
    FakeFaces fake(film());
    const TrackerLimits limits = spreads ? limits_of_search() : limits_with_fake();
    InArena<Tracker> tracker(baked_face().model, limits);
    for (std::size_t k = 0; !tracker->is_started(); ++k) update(tracker.object, film(), k);
    CHECK(fake.is_scored_twice == spreads);
    CHECK((tracker->result().vertices == baked_face().model.base_uv().count) == spreads);  // the base mesh
    CHECK(is_spread(limits.search_work) == spreads);
  }
  // Without work a step a frame; profile S has all stages of the built-in face's alignment in one frame, and its score.
  CHECK(steps_of(0) == 1);
  CHECK(steps_of(profile_s().search_work) == 6);
  CHECK(steps_of(kFaceSearchTuning.cells_for_both - 1) == 18);
  CHECK(steps_of(kFaceSearchTuning.cells_for_both) == 9);
  CHECK(steps_of(TrackerLimits{}.search_work) == 18);
}

TEST_CASE("a sure detection is aligned before the search is complete, another one afterwards") {
  for (const bool is_sure : {true, false}) {
    CAPTURE(is_sure);
    FakeFaces fake(film());
    fake.finds_early = true;
    fake.calls_a_search = 6;
    fake.detection = kFaceSearchTuning.sure_detection + (is_sure ? 0.01f : -0.01f);
    InArena<Tracker> tracker(baked_face().model, limits_of_search());
    for (std::size_t k = 0; fake.alignments == 0 && k < kFrames; ++k) update(tracker.object, film(), k);
    CHECK(fake.alignments == 1);
    CHECK(fake.searches == (is_sure ? 1 : 6));
  }
}

TEST_CASE("a face that is found in a turned frame is aligned at that turn, and has to be sure") {
  for (const bool is_turned : {false, true})
    for (const bool is_sure : {false, true}) {
      FakeFaces fake(film());
      fake.roll_found = is_turned ? 1.5f : 0.0f;
      fake.detection = is_sure ? 0.9999f : 0.9f;
      fake.score = is_sure ? 0.9999f : 0.995f;
      InArena<Tracker> tracker(baked_face().model, limits_with_fake());
      for (std::size_t k = 0; k < 6; ++k) update(tracker.object, film(), k);
      CHECK(fake.roll == fake.roll_found);
      CHECK(tracker->is_started() == (is_sure || !is_turned));
    }
}

TEST_CASE("what a search has detected is aligned, though the next frame does not show it to the detector") {
  FakeFaces fake(film());
  fake.has_ghost = true;  // at the end of the search, and not near its place
  fake.calls_a_search = 2;
  InArena<Tracker> tracker(baked_face().model, limits_of_search());
  for (std::size_t k = 0; !tracker->is_started(); ++k) {
    REQUIRE(k < kFrames);
    update(tracker.object, film(), k);
  }
  CHECK(fake.searches == 2);
  CHECK(fake.alignments == 2);
}

TEST_CASE("a search that the caller begins in the middle of an alignment makes one of its own") {
  FakeFaces fake(film());
  InArena<Tracker> tracker(baked_face().model, limits_of_search());
  std::size_t k = 0;
  while (fake.steps == 0) update(tracker.object, film(), k++);
  REQUIRE(fake.steps < fake.steps_an_alignment);
  REQUIRE(tracker->start_by_detection() == Status::ok);
  const int before = fake.steps;
  while (!tracker->is_started()) {
    REQUIRE(k < kFrames);
    update(tracker.object, film(), k++);
  }
  CHECK(fake.alignments == 2);
  CHECK(fake.steps == before + fake.steps_an_alignment);
}

TEST_CASE(
    "after a track the known person is aligned first, at the place of the track, and keeps markers and "
    "camera") {
  FakeFaces fake(film());
  TrackerLimits limits = limits_of_search();
  limits.markers = 1;
  InArena<Tracker> tracker(baked_face().model, limits);
  const Vec2 nose = film().truth("nose_tip", 0);
  std::vector<NamedPoint> points;
  for (const Landmark& l : baked_face().model.landmarks())
    if (points.size() < limits.start_points) points.push_back({l.name, film().truth(l.name, 0)});
  REQUIRE(tracker->start_from_landmarks(film().view(0), {points.data(), points.size()}, {}, {}, {&nose, 1}) ==
          Status::ok);
  const float focal_px = tracker->camera().f;  // fitted, another one than a search assumes
  const std::vector<std::uint8_t> black(film().frames[0].size(), 0);
  constexpr std::size_t kDark = 20;
  bool is_dark = true;  // from frame kDark on, until the track has ended
  std::size_t k = 1;
  for (; is_dark || !tracker->is_started(); ++k) {
    REQUIRE(k < kFrames);
    is_dark = is_dark && tracker->is_started();
    FrameView view = film().view(k);
    if (k >= kDark && is_dark) view.data = black.data();
    FrameResult result;
    REQUIRE(tracker->update(view, &result) == Status::ok);
  }
  CHECK(tracker->track_number() == 2);
  CHECK(tracker->person_number() == 1);
  CHECK(fake.searches == 0);
  CHECK(fake.alignments == 1);
  CHECK(fake.held_alignments == 1);
  Vec2 x;
  REQUIRE(tracker->marker(0, &x));
  CHECK(length(x - film().truth("nose_tip", k - 1)) < 2);
  CHECK(tracker->camera().f == focal_px);
}

TEST_CASE(
    "a track that stays poor is given up where there are no second looks, each time after twice as many "
    "checks") {
  FakeFaces fake(film());
  fake.error = fake.held_error = 1.5f * kFaceChecksTuning.most_landmark_error;
  InArena<Tracker> tracker(baked_face().model, limits_with_fake());
  std::vector<std::size_t> starts;
  std::uint32_t number = 0;
  for (std::size_t k = 0; k < kFrames; ++k) {
    CHECK(update(tracker.object, film(), k).state != TrackState::tracking);
    if (tracker->is_started() && tracker->track_number() != number) {
      number = tracker->track_number();
      starts.push_back(k);
    }
  }
  REQUIRE(starts.size() == 3);
  const auto first =
      static_cast<std::size_t>(kFaceChecksTuning.poor_checks * kFaceChecksTuning.check_interval_frames);
  CHECK(starts[1] - starts[0] > first - 2);
  CHECK(starts[1] - starts[0] < first + 2);
  CHECK(starts[2] - starts[1] > 2 * first - 2);
  CHECK(starts[2] - starts[1] < 2 * first + 2);
}

TEST_CASE("the patience with poor tracks is that of a new tracker after a start of the caller's") {
  FakeFaces fake(film());
  fake.error = fake.held_error = 1.5f * kFaceChecksTuning.most_landmark_error;
  // Frames of the track that begins in frame k.
  const auto frames_of_track = [](Tracker& tracker, std::size_t k) {
    const std::size_t begin = k;
    while (k < kFrames && update(tracker, film(), k).state != TrackState::lost) ++k;
    return k - begin;
  };
  InArena<Tracker> fresh(baked_face().model, limits_with_fake()),
      used(baked_face().model, limits_with_fake());
  const std::size_t usual = frames_of_track(fresh.object, 0);
  for (std::size_t k = 0; k < kFrames; ++k) update(used.object, film(), k);
  REQUIRE(used->track_number() == 3);
  REQUIRE(used->start_by_detection() == Status::ok);
  CHECK(frames_of_track(used.object, 0) == usual);
  for (std::size_t k = usual + 1; k < kFrames; ++k) update(used.object, film(), k);
  const FaceBox box = fake.box(0);
  const Vec2 half{0.5f * box.side, 0.5f * box.side};
  StartOptions start;
  start.box = BoxConvention::face_box;
  for (Tracker* each : {&fresh.object, &used.object})
    REQUIRE(each->start_from_box(film().view(0), box.center - half, 2.0f * half, start) == Status::ok);
  CHECK(frames_of_track(used.object, 1) == frames_of_track(fresh.object, 1));
}

TEST_CASE("a poor track is not given up where the caller has placed markers, which a new one would lose") {
  FakeFaces fake(film());
  fake.error = fake.held_error = 1.5f * kFaceChecksTuning.most_landmark_error;
  const Vec2 nose = film().truth("nose_tip", 0);
  const FaceBox box = fake.box(0);
  StartOptions start;
  start.box = BoxConvention::face_box;
  const Vec2 half{0.5f * box.side, 0.5f * box.side};
  TrackerLimits limits = limits_with_fake();
  limits.markers = 1;
  InArena<Tracker> marked(baked_face().model, limits);
  REQUIRE(marked->start_from_box(film().view(0), box.center - half, 2.0f * half, start, {}, {&nose, 1}) ==
          Status::ok);
  for (std::size_t k = 1; k < kFrames; ++k)
    CHECK(update(marked.object, film(), k).state == TrackState::degraded);
  CHECK(marked->track_number() == 1);
}

}  // namespace spread_search_test
