// A tracker that finds faces by itself: states, bounded work, memory, recovery. Detection is a fake that knows the truth.
#include <doctest/doctest.h>

#include "fake_faces.hpp"
#include "model_builder.hpp"

namespace face_start_test {
using namespace pliant;

namespace {

constexpr int kWidth = 320, kHeight = 240;
constexpr std::size_t kGone = 20, kBack = 30, kFrames = 58;

/// A face in the left half, gone from frame kGone on, and from frame kBack on in the right half at `scale` of the size.
/// \param turn  of the head when it is back, rad.
FaceFilm make_film(float scale, const char* identity_after, float turn = 0) {
  return FaceFilm(
      kWidth, kHeight, kFrames,
      [=](float s, Pose& pose, auto& q) {
        const auto k = static_cast<std::size_t>(s * (kFrames - 1) + 0.5f);
        const float drift = 0.4f * static_cast<float>(k), z = pose.t.z;
        pose.t.x = -0.2f * z + drift;
        if (k >= kGone && k < kBack) pose.t.x = 50 * z;
        if (k >= kBack) {
          pose.q = exp_rotation({0, turn, 0});
          pose.t.x = 0.15f * z + drift;
          pose.t.z = z / scale;
          pose.t.x /= scale;
          pose.t.y /= scale;
        }
        FaceFilm::set(q, "jawOpen", 0.1f + 0.1f * s);
        FaceFilm::set(q, k < kBack ? "faceWidth" : identity_after, 1.5f);
      },
      0.5f);
}

const FaceFilm& half_size() {
  static const FaceFilm* film = new FaceFilm(make_film(0.6f, "faceWidth"));
  return *film;
}

bool has_face(std::size_t k) {
  return k < kGone || k >= kBack;
}

}  // namespace

TEST_CASE("a tracker needs no start: it finds the face in its first frame and tracks it from there") {
  FakeFaces fake(half_size());
  InArena<Tracker> tracker(baked_face().model, limits_with_fake());
  CHECK_FALSE(tracker->is_started());
  CHECK(tracker->track_number() == 0);
  const FrameResult first = update(tracker.object, half_size(), 0);
  CHECK(first.state == TrackState::tracking);
  CHECK_FALSE(first.is_searching);
  CHECK(first.landmark_error == doctest::Approx(0.02));
  CHECK(tracker->is_started());
  for (std::size_t k = 1; k < kGone; ++k) {
    const FrameResult result = update(tracker.object, half_size(), k);
    CHECK(result.state == TrackState::tracking);
    CHECK(half_size().landmark_error(tracker.object, k) < 2);
  }
  CHECK(fake.searches == 1);
  CHECK(fake.verifications >= 4);
  CHECK(tracker->track_number() == 1);
  CHECK(tracker->person_number() == 1);
}

TEST_CASE(
    "a face that leaves is told lost within 5 frames, and found again at another place and size within 15") {
  for (const float scale : {0.5f, 2.0f}) {
    CAPTURE(scale);
    const FaceFilm film = make_film(scale, "faceWidth");
    FakeFaces fake(film);
    InArena<Tracker> tracker(baked_face().model, limits_with_fake());
    std::size_t lost = 0, back = 0;
    std::vector<float> person;
    float focal = 0;
    for (std::size_t k = 0; k < kFrames; ++k) {
      const FrameResult result = update(tracker.object, film, k);
      if (k + 1 == kGone) {
        person.assign(tracker->parameters().begin(), tracker->parameters().end());
        focal = tracker->camera().f;
      }
      if (lost == 0 && result.state == TrackState::lost) lost = k;
      if (k >= kBack && back == 0 && result.state == TrackState::tracking) back = k;
      if (back > 0) CHECK(film.landmark_error(tracker.object, k) < 5);
      if (!has_face(k) && k > lost && lost > 0) CHECK(result.state == TrackState::lost);
    }
    CHECK(lost < kGone + 5);
    CHECK(lost >= kGone);
    CHECK(back < kBack + 15);
    REQUIRE(back > 0);
    // The same person: identity and focal length are those of before.
    CHECK(tracker->camera().f == focal);
    for (std::size_t i = 0; i < person.size(); ++i)
      if (baked_face().model.parameters()[i].group == Group::identity)
        CHECK(tracker->parameters()[i] == person[i]);
  }
}

TEST_CASE("markers stay with a person who is found again, and not with another one") {
  for (const bool is_same : {true, false}) {
    CAPTURE(is_same);
    const FaceFilm film = make_film(0.6f, "faceWidth");
    FakeFaces fake(film);
    TrackerLimits limits = limits_with_fake();
    limits.markers = 2;
    InArena<Tracker> tracker(baked_face().model, limits);
    const Vec2 places[] = {film.truth("ibug30", 0), film.truth("ibug36", 0)};
    REQUIRE(film.start_at_truth(tracker.object, 0, {}, {places, 2}) == Status::ok);
    constexpr std::size_t kLast = kFrames - 2;
    for (std::size_t k = 1; k <= kLast; ++k) {
      if (k == kGone && !is_same) fake.held_error = 0.2f;
      update(tracker.object, film, k);
    }
    REQUIRE(tracker->is_started());
    CHECK(tracker->track_number() == 2);
    CHECK(tracker->person_number() == (is_same ? 1 : 2));
    for (std::size_t k = 0; k < 2; ++k) {
      Vec2 x;
      REQUIRE(tracker->marker(k, &x) == is_same);
      if (is_same) CHECK(length(x - film.truth(k == 0 ? "ibug30" : "ibug36", kLast)) < 3);
    }
    CHECK(tracker->start_by_detection() == Status::ok);  // forgets the person
    update(tracker.object, film, kLast + 1);
    CHECK(tracker->person_number() == (is_same ? 2 : 3));
    Vec2 x;
    CHECK_FALSE(tracker->marker(0, &x));
  }
}

TEST_CASE("another person is looked for with the camera of the start, if that has succeeded") {
  const FaceFilm& film = half_size();
  FakeFaces fake(film);
  fake.verification = 0.01f;  // tracks are given up before the person is known
  InArena<Tracker> tracker(baked_face().model, limits_with_fake());
  Camera camera = film.camera;
  camera.f *= 1.25f;
  Pose pose = film.poses[0];
  pose.t.z *= 1.25f;
  REQUIRE(tracker->start_from_pose(film.view(0), camera, pose, nullptr) == Status::ok);
  std::size_t k = 1;
  for (; tracker->is_started(); ++k) update(tracker.object, film, k);
  update(tracker.object, film, k++);
  REQUIRE(tracker->is_started());
  CHECK(tracker->camera().f == camera.f);
  Camera broken = camera;
  broken.f = -1;
  CHECK(tracker->start_from_pose(film.view(k), broken, pose, nullptr) == Status::bad_argument);
  StartOptions start;
  start.camera = &broken;
  CHECK(tracker->start_from_box(film.view(k), {100, 60}, {90, 90}, start) != Status::ok);
  CHECK_FALSE(tracker->is_started());
  update(tracker.object, film, k++);
  REQUIRE(tracker->is_started());
  CHECK(tracker->camera().f == camera.f);
}

TEST_CASE("the landmark error of a start that fails is not that of the next one") {
  const FaceFilm& film = half_size();
  FakeFaces fake(film);
  InArena<Tracker> tracker(baked_face().model, limits_with_fake());
  FrameView flat = film.view(0);
  const std::vector<std::uint8_t> black(static_cast<std::size_t>(kWidth * kHeight), 0);
  flat.data = black.data();
  const FaceBox box = fake.box(0);
  StartOptions start;
  start.box = BoxConvention::face_box;
  CHECK(tracker->start_from_box(flat, box.center - 0.5f * Vec2{box.side, box.side}, {box.side, box.side},
                                start) == Status::too_few_points);
  CHECK(fake.alignments == 1);
  fake.verification = 0.3f;  // too low for a first check, which does not set the error
  REQUIRE(film.start_at_pose(tracker.object, 1) == Status::ok);
  CHECK(tracker->result().landmark_error == 0);
}

TEST_CASE("frames beyond what a detector searches are tracked after a start, and need one") {
  FakeFaces fake(half_size());
  TrackerLimits limits = limits_with_fake();
  limits.width = kLargestFramePx + 1;
  limits.height = 64;
  limits.patches = 8;
  limits.key_patches = 0;
  InArena<Tracker> tracker(baked_face().model, limits);
  CHECK(tracker->start_by_detection() == Status::not_found);
}

TEST_CASE(
    "another person who is found is fitted anew: by the identity that is aligned, or since the known one "
    "does not fit") {
  const FaceFilm film = make_film(0.6f, "noseLength");
  // Where an alignment takes several frames, identities are not compared.
  for (const bool spreads_work : {false, true}) {
    CAPTURE(spreads_work);
    FakeFaces fake(film);
    fake.steps_an_alignment = 1;
    TrackerLimits limits = limits_with_fake();
    if (spreads_work) limits.search_work = kFaceSearchTuning.cells_for_both - 1;
    InArena<Tracker> tracker(baked_face().model, limits);
    float before = 0, after = 0;
    for (std::size_t k = 0; k < kGone; ++k) update(tracker.object, film, k);
    REQUIRE(tracker->parameter("noseLength", &before) == Status::ok);
    if (spreads_work) fake.held_error = 0.2f;
    for (std::size_t k = kGone; k < kFrames; ++k) update(tracker.object, film, k);
    CHECK((fake.held_alignments > 0) == spreads_work);
    REQUIRE(tracker->parameter("noseLength", &after) == Status::ok);
    CHECK(after > before + 0.4f);
  }
}

TEST_CASE(
    "a head that comes back turned by more than 20 degrees is not told from the known one by its identity") {
  const FaceFilm film = make_film(0.6f, "noseLength", 0.4f);
  FakeFaces fake(film);
  InArena<Tracker> tracker(baked_face().model, limits_with_fake());
  for (std::size_t k = 0; k < kFrames; ++k) update(tracker.object, film, k);
  CHECK(fake.held_alignments > 0);
}

TEST_CASE(
    "a start of the caller's tells nothing of how its person is aligned: whom the alignment fits is the same "
    "person") {
  const FaceFilm film = make_film(0.6f, "noseLength");
  FakeFaces fake(film);
  InArena<Tracker> tracker(baked_face().model, limits_with_fake());
  update(tracker.object, film, 0);
  REQUIRE(film.start_at_truth(tracker.object, 1) == Status::ok);
  for (std::size_t k = 2; k < kFrames; ++k) update(tracker.object, film, k);
  float after = 0;
  REQUIRE(tracker->parameter("noseLength", &after) == Status::ok);
  CHECK(fake.held_alignments > 0);
  CHECK(after < 0.5f);
}

TEST_CASE(
    "the work of a frame is bounded: a part of the search, or steps of an alignment, and a start has but the "
    "last one") {
  FakeFaces fake(half_size());
  fake.calls_a_search = 4;
  fake.steps_an_alignment = 3;
  fake.has_ghost = true;
  TrackerLimits limits = limits_with_fake();
  limits.search_work = 2 * kFaceSearchTuning.cells_a_step_alone;
  InArena<Tracker> tracker(baked_face().model, limits);
  for (std::size_t k = 0; k < kGone; ++k) {
    const int searches = fake.searches, steps = fake.steps;
    const FrameResult result = update(tracker.object, half_size(), k);
    CHECK(fake.work == limits.search_work);
    const std::size_t needed =
        4 + 2 * 2;  // parts of the search; the ghost and the face, three steps in two frames each
    const int searched = fake.searches - searches, taken = fake.steps - steps;
    CHECK(searched == (k < 4));
    CHECK(taken <= (k < 4 ? 0 : 2));
    CHECK(taken >= (k < 4 || k >= needed ? 0 : 1));
    if (k + 1 == needed) CHECK(taken == 1);
    CHECK(result.is_searching == (k + 1 < needed));
    CHECK((result.state == TrackState::tracking) == (k + 1 >= needed));
    CHECK(result.landmark_error == (k + 1 < needed ? 0 : doctest::Approx(0.02)));
  }
}

TEST_CASE(
    "a step a frame: the least work finds a face too, and one that leaves during its alignment starts "
    "nothing") {
  TrackerLimits limits = limits_with_fake();
  limits.search_work = 0;
  for (const bool leaves : {false, true}) {
    CAPTURE(leaves);
    FakeFaces fake(half_size());
    InArena<Tracker> tracker(baked_face().model, limits);
    FrameResult result;
    for (std::size_t k = leaves ? kGone - 3 : 0; k < (leaves ? kBack : kGone); ++k)
      result = update(tracker.object, half_size(), k);
    CHECK((result.state == TrackState::lost) == leaves);
    CHECK(result.is_searching == leaves);
    CHECK(fake.alignments == 1);
    CHECK(fake.steps == 6);
    if (!leaves) CHECK(result.vertices == baked_face().model.base_uv().count);  // no work on the mesh
  }
}

TEST_CASE(
    "a track from one side only is given up after four black frames, whatever the limits: a search in parts "
    "begins where it was") {
  for (const std::uint8_t key_frames : {std::uint8_t{2}, std::uint8_t{4}}) {
    FakeFaces fake(half_size());
    fake.calls_a_search = 8;
    TrackerLimits limits = limits_with_fake();
    limits.search_work = 2 * kFaceSearchTuning.cells_a_step_alone;
    limits.key_frames = key_frames;
    InArena<Tracker> tracker(baked_face().model, limits);
    REQUIRE(half_size().start_at_pose(tracker.object) == Status::ok);
    const std::vector<std::uint8_t> black(kWidth * kHeight, 0);
    std::size_t n = 1;
    for (; tracker->is_started(); ++n) {
      FrameView view = half_size().view(n);
      view.data = black.data();
      FrameResult result;
      REQUIRE(tracker->update(view, &result) == Status::ok);
    }
    CHECK(n - 1 == 4);
    for (std::size_t k = 0; k < 4; ++k) update(tracker.object, half_size(), n + k);
    CHECK(tracker->is_started());
    CHECK(fake.searches == 0);
    CHECK(fake.alignments == 1);
  }
}

TEST_CASE("a place where a track was and no face is any more: the search goes on everywhere") {
  FakeFaces fake(half_size());
  TrackerLimits limits = limits_with_fake();
  limits.search_work = 2 * kFaceSearchTuning.cells_a_step_alone;
  InArena<Tracker> tracker(baked_face().model, limits);
  const std::size_t begin = kGone - 2;
  REQUIRE(half_size().start_at_pose(tracker.object, begin) == Status::ok);
  for (std::size_t k = begin + 1; k < kFrames; ++k) update(tracker.object, half_size(), k);
  CHECK(fake.searches > 0);
  CHECK(tracker->is_started());
  CHECK(fake.alignments == 1);
}

TEST_CASE("a search in parts that saw the face at another size only: it is aligned at its own") {
  FakeFaces fake(half_size());
  fake.calls_a_search = 2;
  fake.size_found = 1.33f;
  TrackerLimits limits = limits_with_fake();
  limits.search_work = kFaceSearchTuning.cells_a_step_alone;
  InArena<Tracker> tracker(baked_face().model, limits);
  for (std::size_t k = 0; k < kGone; ++k) update(tracker.object, half_size(), k);
  CHECK(tracker->is_started());
  CHECK(fake.alignments == 1);
}

TEST_CASE("a start of the caller's during a search ends it, and one during an alignment") {
  const FaceFilm& film = half_size();
  TrackerLimits limits = limits_with_fake();
  limits.search_work = kFaceSearchTuning.cells_a_step_alone;
  for (const std::size_t begin : {std::size_t{1}, std::size_t{6}}) {  // in the search; in the alignment
    FakeFaces fake(film);
    fake.calls_a_search = 4;
    InArena<Tracker> tracker(baked_face().model, limits);
    for (std::size_t k = 0; k < begin; ++k) CHECK(update(tracker.object, film, k).is_searching);
    REQUIRE(film.start_at_pose(tracker.object, begin) == Status::ok);
    CHECK(tracker->is_started());
    CHECK_FALSE(tracker->result().is_searching);
    const int steps = fake.steps;
    for (std::size_t k = begin + 1; k < kGone; ++k)
      CHECK(update(tracker.object, film, k).state == TrackState::tracking);
    CHECK(fake.steps == steps);
    REQUIRE(tracker->start_by_detection() == Status::ok);
    CHECK(update(tracker.object, film, kBack).is_searching);
    CHECK(fake.searches % 4 == (begin < 4 ? 2 : 1));  // from the beginning
  }
}

TEST_CASE(
    "an alignment with a low score is no start, and nothing can be asked of a track that is not there") {
  FakeFaces fake(half_size());
  fake.score = 0.5f;
  InArena<Tracker> tracker(baked_face().model, limits_with_fake());
  for (std::size_t k = 0; k < kGone; ++k) {
    const FrameResult result = update(tracker.object, half_size(), k);
    CHECK(result.state == TrackState::lost);
    CHECK(result.is_searching);
    Vec2 x;
    float value;
    CHECK_FALSE(tracker->is_started());
    CHECK_FALSE(tracker->estimator().is_started());
    CHECK(tracker->landmark("ibug30", &x) == Status::not_started);
    CHECK(tracker->parameter("jawOpen", &value) == Status::not_started);
    CHECK(tracker->place_landmarks({}) == Status::not_started);
    CHECK_FALSE(tracker->patch(0, &x));
    CHECK(tracker->key_frame_count() == 0);
    CHECK(tracker->parameters().count == baked_face().model.parameters().count);
  }
  CHECK(fake.alignments > 0);
  FrameResult result;
  CHECK(tracker->update(half_size().view(0), &result) == Status::stale_frame);
}

TEST_CASE("tables that cannot be used are told by each update, and starts without them work") {
  FakeFaces fake(half_size());
  fake.status = Status::bad_checksum;
  InArena<Tracker> tracker(baked_face().model, limits_with_fake());
  FrameResult result;
  CHECK(tracker->update(half_size().view(0), &result) == Status::bad_checksum);
  CHECK(tracker->update(half_size().view(0), &result) ==
        Status::bad_checksum);  // the frame has not been taken
  CHECK(result.is_searching == FrameResult{}.is_searching);
  CHECK(half_size().start_at_pose(tracker.object, 1) == Status::ok);
  CHECK(update(tracker.object, half_size(), 2).state == TrackState::tracking);
}

TEST_CASE("checks that refuse a track end it, and the person who was tracked before is known") {
  FakeFaces fake(half_size());
  InArena<Tracker> tracker(baked_face().model, limits_with_fake());
  for (std::size_t k = 0; k < 9; ++k)
    CHECK(update(tracker.object, half_size(), k).state == TrackState::tracking);
  fake.verification = 0.05f;
  CHECK(update(tracker.object, half_size(), 9).state == TrackState::tracking);
  FrameResult result;
  for (std::size_t k = 10; result.state != TrackState::lost || k == 10; ++k) {
    REQUIRE(k < 9 + kFaceChecksTuning.known_interval_frames + 2);
    result = update(tracker.object, half_size(), k);
  }
  CHECK(result.is_searching);
  CHECK((result.pose.t.z == 1000 && result.pose.q.w == 1));  // as without a track
  CHECK(tracker->camera().f == 0);
  CHECK(tracker->work().searches > 0);
  const int held = fake.held_alignments;
  fake.verification = 0.99f;
  update(tracker.object, half_size(), kBack);
  CHECK(fake.held_alignments == held + 1);
  CHECK(tracker->is_started());
}

TEST_CASE("a doubtful face is tracked after three frames in which it was accepted; when it is back, as the same person") {
  FakeFaces fake(half_size());
  fake.detection = 0.9f;
  InArena<Tracker> tracker(baked_face().model, limits_with_fake());
  CHECK(update(tracker.object, half_size(), 0).is_searching);
  CHECK(update(tracker.object, half_size(), 1).is_searching);
  fake.score = 0.5f;
  CHECK(update(tracker.object, half_size(), 2).is_searching);
  fake.score = 0.99f;
  CHECK(update(tracker.object, half_size(), 3).is_searching);
  CHECK(update(tracker.object, half_size(), 4).is_searching);
  CHECK(update(tracker.object, half_size(), 5).state == TrackState::tracking);
  std::size_t k = 6;
  for (; k < kBack || (k < kFrames && !tracker->is_started()); ++k) update(tracker.object, half_size(), k);
  CHECK(k == kBack + 5);  // three as anybody, the last of them the first of three as the same person
}

TEST_CASE("a poor start is degraded") {
  FakeFaces fake(half_size());
  fake.error = 0.12f;
  InArena<Tracker> tracker(baked_face().model, limits_with_fake());
  CHECK(update(tracker.object, half_size(), 0).state == TrackState::degraded);
  fake.error = 0.03f;
  FrameResult result;
  for (std::size_t k = 1; k < kGone; ++k) result = update(tracker.object, half_size(), k);
  CHECK(result.state == TrackState::tracking);
  CHECK(result.landmark_error < 0.08f);
}

TEST_CASE("a track that was put on the background is told lost within 5 frames, and then finds the face") {
  FakeFaces fake(half_size());
  InArena<Tracker> tracker(baked_face().model, limits_with_fake());
  Pose beside = half_size().poses[0];
  beside.t.x += 0.3f * beside.t.z;
  REQUIRE(tracker->start_from_pose(half_size().view(0), half_size().camera, beside, nullptr) == Status::ok);
  std::size_t lost = 0;
  FrameResult result;
  for (std::size_t k = 1; k < kGone; ++k) {
    result = update(tracker.object, half_size(), k);
    if (lost == 0 && result.state == TrackState::lost) lost = k;
  }
  CHECK(lost > 0);
  CHECK(lost <= 5);
  CHECK(result.state == TrackState::tracking);
  CHECK(half_size().landmark_error(tracker.object, kGone - 1) < 2);
}

TEST_CASE("black, frozen and torn frames do not end a good track") {
  FakeFaces fake(half_size());
  InArena<Tracker> tracker(baked_face().model, limits_with_fake());
  const std::vector<std::uint8_t> black(static_cast<std::size_t>(kWidth * kHeight), 0);
  for (std::size_t k = 0; k < kGone; ++k) {
    FrameView view = half_size().view(k);
    std::vector<std::uint8_t> torn = half_size().frames[k];
    if (k % 3 == 1) {
      view.data = black.data();
    } else if (k % 3 == 2) {
      for (std::size_t i = torn.size() / 2; i < torn.size(); ++i) torn[i] = half_size().frames[k][i - 100];
      view.data = torn.data();
    }
    if (FrameResult result; tracker->update(view, &result) != Status::ok || result.state == TrackState::lost)
      FAIL_CHECK(k);
  }
  CHECK(fake.searches == 1);
}

}  // namespace face_start_test
