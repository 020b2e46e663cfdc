// Tracks that begin while something covers the face. Detection and alignment are a fake that knows the truth.
#include "track/second_look.hpp"

#include <doctest/doctest.h>

#include <map>
#include <tuple>

#include "face/turned_picture.hpp"
#include "fake_faces.hpp"
#include "model_builder.hpp"
#include "track/template_tuning.hpp"

namespace second_look_test {

using namespace pliant;

namespace {

constexpr std::size_t kFrames = 60;

/// A face that moves a little, drawn once. \param first, last  turn about the vertical axis, rad, in frame 0 and after a fifth of
/// the film.
const FaceFilm& film(float first = 0, float last = 0, std::size_t frames = kFrames) {
  static auto& films = *new std::map<std::tuple<float, float, std::size_t>, FaceFilm>;
  const auto motion = [=](float s, Pose& pose, auto&) {
    pose.q = exp_rotation({0, first + (last - first) * min(1.0f, 5 * s), 0});
    pose.t.x += 20 * s;
  };
  const std::tuple key(first, last, frames);
  if (films.count(key) == 0) films.emplace(key, FaceFilm(320, 240, frames, motion, 0.5f));
  return films.at(key);
}

/// How far below its truth the middle of the lower lip is, px.
float mouth_error(Tracker& tracker, const FaceFilm& of, std::size_t k) {
  Vec2 x;
  REQUIRE(tracker.landmark("ibug57", &x) == Status::ok);
  return x.y - of.truth("ibug57", k).y;
}

/// What a tracker that starts by itself makes of a film.
struct Run {
  int starts = 0;              // tracks that began
  std::size_t last_start = 0;  // frame of the last one
  int lost = 0;                // frames without one
  float error = 0;             // mouth_error in the last frame
};

Run run(const FaceFilm& of, const TrackerLimits& limits) {
  InArena<Tracker> tracker(baked_face().model, limits);
  Run result;
  for (std::size_t k = 0; k < kFrames; ++k) {
    const float before = k == 0 ? 0 : mouth_error(tracker.object, of, k - 1);
    const FrameResult frame = update(tracker.object, of, k);
    result.lost += frame.state == TrackState::lost;
    result.error = mouth_error(tracker.object, of, k);
    if (k > 0 && magnitude(result.error - before) < 3) continue;  // a mean moves by less
    ++result.starts;
    result.last_start = k;
  }
  return result;
}

/// The first frame of the second track of a film whose face is covered at first.
std::size_t frame_of_second_track(const TrackerLimits& limits) {
  InArena<Tracker> tracker(baked_face().model, limits);
  for (std::size_t k = 0; k < kFrames; ++k) {
    update(tracker.object, film(), k);
    if (tracker->track_number() == 2) return k;
  }
  return kFrames;
}

constexpr std::size_t kLong = 100;

/// Runs a tracker from the end of one alignment to that of the next, and has the next look better than the start, or not.
struct Looks {
  FakeFaces fake{film(0, 0, kLong)};
  InArena<Tracker> tracker{baked_face().model, limits_with_looks()};
  std::size_t k = 0;

  Looks() {
    fake.covered_frames = 10;
    fake.covered_error = fake.tracked_error = 0.024f;  // one better look alone proves nothing
  }
  /// \return false: the film has ended before.
  bool run_to_next(bool is_better) {
    fake.error = is_better ? 0.02f : 0.07f;
    const int end = fake.steps + fake.steps_an_alignment;
    bool is_over = false;
    for (; k < kLong && !is_over; ++k) {
      is_over = fake.steps == end;  // a new track begins in the frame after
      update(tracker.object, film(0, 0, kLong), k);
    }
    return is_over;
  }
};

}  // namespace

TEST_CASE("a track that began with a covered mouth begins anew once it is seen, and no frame is lost") {
  FakeFaces fake(film());
  fake.covered_frames = 10;
  const Run looking = run(film(), limits_with_looks());
  CHECK(looking.starts == 2);
  CHECK(looking.lost == 0);
  CHECK(magnitude(looking.error) < 1.5f);
  CHECK(fake.searches == 1);
  const Run plain = run(film(), limits_with_fake());
  CHECK(plain.starts == 1);
  CHECK(plain.error > 6);
}

TEST_CASE("the work of a track that begins anew is shared by three frames, where pictures last") {
  FakeFaces fake(film());
  fake.covered_frames = 10;
  TrackerLimits limits = limits_with_looks();
  const std::size_t begin = frame_of_second_track(limits);
  REQUIRE(begin + 4 < kFrames);
  {
    InArena<Tracker> tracker(baked_face().model, limits);
    std::vector<FrameResult> frames;
    for (std::size_t k = 0; k < begin + 4; ++k) frames.push_back(update(tracker.object, film(), k));
    for (const FrameResult& frame : frames) CHECK(frame.state == TrackState::tracking);
    const int all = frames[begin - 1].tracked;
    CHECK(frames[begin].tracked <= limits.patches / kTemplatePlacementTuning.start_divisor);
    CHECK(frames[begin + 1].tracked > 2 * frames[begin].tracked);
    CHECK(frames[begin + 2].tracked > frames[begin + 1].tracked);  // edges
    CHECK(frames[begin + 3].tracked > 0.8f * static_cast<float>(all));
  }
  limits.keeps_previous = false;
  CHECK(frame_of_second_track(limits) == begin - 1);
}

TEST_CASE("a track of few templates begins anew, too") {
  FakeFaces fake(film());
  fake.covered_frames = 10;
  TrackerLimits limits = limits_with_looks();
  limits.patches = 20;
  limits.edges = nullptr;
  const std::size_t begin = frame_of_second_track(limits);
  REQUIRE(begin < kFrames);
  InArena<Tracker> tracker(baked_face().model, limits);
  for (std::size_t k = 0; k < kFrames; ++k)
    CHECK(update(tracker.object, film(), k).state == TrackState::tracking);
  CHECK(tracker->track_number() == 2);
}

TEST_CASE("what the caller does before a new track has begun comes first") {
  FakeFaces fake(film());
  fake.covered_frames = 10;
  const std::size_t begin = frame_of_second_track(limits_with_looks());
  REQUIRE(begin < kFrames);
  InArena<Tracker> tracker(baked_face().model, limits_with_looks());
  for (std::size_t k = 0; k < begin; ++k) update(tracker.object, film(), k);
  const FaceFilm& f = film();
  std::uint32_t tracks = 1;
  SUBCASE("it places a landmark") {
    const NamedPoint point{"ibug30", f.truth("ibug30", begin - 1)};
    REQUIRE(tracker->place_landmarks({&point, 1}) == Status::ok);
  }
  SUBCASE("it starts a track") {
    REQUIRE(f.start_at_truth(tracker.object, begin - 1) == Status::ok);
    tracks = 2;
  }
  SUBCASE("it lets the tracker search") {
    REQUIRE(tracker->start_by_detection({}) == Status::ok);
    tracks = 2;
  }
  update(tracker.object, f, begin);
  CHECK(tracker->track_number() == tracks);
  CHECK(update(tracker.object, f, begin + 1).state == TrackState::tracking);
}

TEST_CASE("a second alignment that is not better changes nothing") {
  const struct {
    std::string what;
    std::size_t covered_frames = 10;
    float covered_error = 0.025f, lowered_px = 8, error = 0.02f, tracked_error = 0, score = 0.999f;
  } kCases[] = {
      {"never covered", 0},
      {"covered all the time", kFrames, 0.02f},
      {"in the same place", 10, 0.025f, 0, 0.018f},
      {"hardly better by its estimate", 10, 0.0205f},
      {"probably no face", 10, 0.025f, 8, 0.018f, 0, 0.94f},
      {"worse than the start says of itself", 10, 0.025f, 8, 0.06f, 0.1f},
      {"worse than the checks say of the track", 10, 0.025f, 8, 0.0225f, 0.02f},
  };
  for (const auto& c : kCases) {
    CAPTURE(c.what);
    FakeFaces fake(film());
    fake.covered_frames = c.covered_frames;
    fake.covered_error = c.covered_error;
    fake.lowered_px = c.lowered_px;
    fake.error = c.error;
    fake.tracked_error = c.tracked_error;
    fake.score = c.score;
    CHECK(run(film(), limits_with_looks()).starts == 1);
    CHECK(fake.alignments == 3);  // after another start looks would come sooner
  }
}

TEST_CASE("looks that are not better count for the mean of the landmarks, if they are good") {
  const struct {
    std::string what;
    float of_start, of_look, score = 0.999f, turn = 0;
    float error =
        8;  // of the mouth after the two looks of the film, px; half of it if they count, as a start does
  } kCases[] = {
      {"hardly better", 0.021f, 0.02f, 0.999f, 0, 4},
      {"a little worse", 0.02f, 0.0235f, 0.999f, 0, 4},
      {"a little worse, turned by 20 degrees", 0.02f, 0.0235f, 0.999f, 0.35f, 4},
      {"turned by 30 degrees", 0.02f, 0.0235f, 0.999f, 0.52f},
      {"worse than the start", 0.02f, 0.0245f},
      {"bad, as the start was", 0.042f, 0.041f},
      {"probably no face", 0.021f, 0.02f, 0.94f},
  };
  for (const auto& c : kCases) {
    CAPTURE(c.what);
    const FaceFilm& turning = film(0, c.turn);
    FakeFaces fake(turning);
    fake.covered_frames = 10;
    fake.covered_error = c.of_start;
    fake.error = c.of_look;
    fake.score = c.score;
    const Run result = run(turning, limits_with_looks());
    CHECK(result.starts == 1);
    CHECK(magnitude(result.error - c.error) < 1);
  }
}

TEST_CASE("one second alignment alone proves something only if it is much better") {
  for (const float of_start : {0.024f, 0.05f}) {
    CAPTURE(of_start);
    FakeFaces fake(film());
    fake.covered_frames = 10;
    fake.covered_error = of_start;
    InArena<Tracker> tracker(baked_face().model, limits_with_looks());
    for (std::size_t k = 0; k < kFrames; ++k) {
      update(tracker.object, film(), k);
      if (fake.alignments > 2) fake.error = 0.07f;  // the first look is better, the later ones are not
    }
    CHECK(fake.alignments >= 3);
    CHECK((mouth_error(tracker.object, film(), kFrames - 1) > 6) == (of_start == 0.024f));
  }
}

TEST_CASE("two looks that prove something together are a second apart: they see two expressions") {
  FakeFaces fake(film());
  fake.covered_frames = 10;
  fake.covered_error = 0.024f;
  const Run result = run(film(), limits_with_looks());
  CHECK(result.starts == 2);
  CHECK(result.last_start >= kSecondLookTuning.first_wait + 25);
}

TEST_CASE(
    "looks that prove something together are in a row: one that is not better takes the first one back") {
  Looks looks;
  REQUIRE(looks.run_to_next(true));  // the start
  for (const bool is_better : {true, false, true}) REQUIRE(looks.run_to_next(is_better));
  CHECK(looks.tracker->track_number() == 1);
}

TEST_CASE("after a better look the next one comes soon, however long looks have waited before") {
  Looks looks;
  REQUIRE(looks.run_to_next(true));  // the start
  REQUIRE(looks.run_to_next(false));
  REQUIRE(looks.run_to_next(true));
  const std::size_t first_better = looks.k;
  REQUIRE(looks.run_to_next(true));
  CHECK(looks.k - first_better <= kSecondLookTuning.wait_if_better + 10);
  CHECK(looks.tracker->track_number() == 2);
}

TEST_CASE("a look of the track before proves nothing of the next one") {
  Looks looks;
  REQUIRE(looks.run_to_next(true));  // the start
  REQUIRE(looks.run_to_next(true));
  looks.fake.covered_frames = kLong;
  REQUIRE(looks.tracker->start_by_detection({}) == Status::ok);
  REQUIRE(looks.run_to_next(true));
  REQUIRE(looks.tracker->track_number() == 2);
  looks.fake.covered_frames = 10;
  REQUIRE(looks.run_to_next(true));
  CHECK(looks.tracker->track_number() == 2);
  REQUIRE(looks.run_to_next(true));
  CHECK(looks.tracker->track_number() == 3);
}

TEST_CASE("an alignment of a turned face counts only if it is sure and the start was turned, too") {
  const struct {
    std::string what;
    float first, last, of_start, of_track;
    int starts;
  } kCases[] = {
      {"turned, and hardly better", 0.5f, 0.5f, 0.024f, 0.024f, 1},
      {"turned, and much better", 0.5f, 0.5f, 0.05f, 0.05f, 2},
      {"much better, but the start was frontal", 0, 0.5f, 0.05f, 0.05f, 1},
      {"frontal, as good as a turned start", 0.5f, 0, 0.02f, 0.02f, 2},
      {"frontal, as good as a turned start, worse than its track", 0.5f, 0, 0.02f, 0.019f, 2},
      {"frontal, worse than a turned start, better than its track", 0.5f, 0, 0.019f, 0.023f, 1},
      {"frontal, as good as a frontal start", 0, 0, 0.02f, 0.02f, 1},
  };
  for (const auto& c : kCases) {
    CAPTURE(c.what);
    const FaceFilm& turning = film(c.first, c.last);
    FakeFaces fake(turning);
    fake.covered_frames = 10;
    fake.covered_error = c.of_start;
    fake.tracked_error = c.of_track;
    CHECK(run(turning, limits_with_looks()).starts == c.starts);
  }
}

TEST_CASE("who tells the tracker where landmarks or markers are, or who the person is, is not corrected") {
  FakeFaces fake(film());
  fake.covered_frames = 1;
  TrackerLimits limits = limits_with_looks();
  limits.markers = 1;
  InArena<Tracker> tracker(baked_face().model, limits);
  SUBCASE("a pose with the person") {
    REQUIRE(film().start_at_truth(tracker.object) == Status::ok);
  }
  SUBCASE("many landmarks") {
    std::vector<std::string> names;
    std::vector<NamedPoint> points;
    for (int l = 17; l < 68; ++l) names.push_back("ibug" + std::to_string(l));
    for (const std::string& name : names) points.push_back({name.c_str(), film().truth(name, 0)});
    REQUIRE(tracker->start_from_landmarks(film().view(0), {points.data(), points.size()}) == Status::ok);
  }
  SUBCASE("few landmarks, with a marker") {
    const char* const names[] = {"ibug36", "ibug45", "ibug33", "ibug48", "ibug54"};
    std::vector<NamedPoint> points;
    for (const char* name : names) points.push_back({name, film().truth(name, 0)});
    const Vec2 marker = film().truth("ibug30", 0);
    REQUIRE(tracker->start_from_landmarks(film().view(0), {points.data(), points.size()}, {}, {},
                                          {&marker, 1}) == Status::ok);
  }
  SUBCASE(
      "few landmarks, with a marker far beside the head, which is behind the camera when the head has "
      "turned") {
    static const FaceFilm* turning = new FaceFilm(
        320, 240, kFrames,
        [](float s, Pose& pose, auto&) {
          pose.q = exp_rotation({0, 0.5f * min(1.0f, 5 * s), 0});
        },
        0.5f);
    FakeFaces turns(*turning);
    const Vec2 far{1500, 120};
    InArena<Tracker> marked(baked_face().model, limits);
    std::vector<NamedPoint> points;
    for (const char* name : {"ibug36", "ibug45", "ibug33", "ibug48", "ibug54"})
      points.push_back({name, turning->truth(name, 0)});
    REQUIRE(marked->start_from_landmarks(turning->view(0), {points.data(), points.size()}, {}, {},
                                         {&far, 1}) == Status::ok);
    const int at_start = turns.alignments;
    for (std::size_t k = 1; k < kFrames; ++k) update(marked.object, *turning, k);
    Vec2 x;
    CHECK_FALSE(marked->marker(0, &x));
    CHECK(turns.alignments == at_start);
    return;
  }
  SUBCASE("a face that is found, and a landmark that is then placed") {
    update(tracker.object, film(), 0);
    const NamedPoint point{"ibug30", film().truth("ibug30", 0)};
    REQUIRE(tracker->place_landmarks({&point, 1}) == Status::ok);
  }
  const int before = fake.alignments;
  for (std::size_t k = 1; k < kFrames; ++k) update(tracker.object, film(), k);
  CHECK(fake.alignments == before);
}

TEST_CASE("a look that ends where landmarks are placed keeps other rare work from no frame") {
  const FaceFilm& turning = film(0, 0.5f, 150);
  std::vector<std::size_t> keys[2];  // frames
  for (const bool places : {false, true}) {
    FakeFaces fake(turning);
    InArena<Tracker> tracker(baked_face().model, limits_with_looks());
    std::size_t k = 0;
    while (fake.steps <= fake.steps_an_alignment) update(tracker.object, turning, k++);  // a look has begun
    const NamedPoint point{"ibug30", turning.truth("ibug30", k - 1)};
    if (places) REQUIRE(tracker->place_landmarks({&point, 1}) == Status::ok);
    while (k < kFrames) {
      const std::size_t before = tracker->key_frame_count();
      update(tracker.object, turning, k++);
      if (tracker->key_frame_count() > before) keys[places].push_back(k);
    }
  }
  CHECK(keys[0].size() > 0);
  CHECK(keys[1] == keys[0]);
}

TEST_CASE("looks give no offsets to who wants the model's landmarks") {
  FakeFaces fake(film());
  fake.covered_frames = 10;
  fake.covered_error = 0.021f;  // a mean that would move them
  InArena<Tracker> tracker(baked_face().model, limits_with_looks());
  TrackerOptions options;
  options.keeps_landmark_offsets = false;
  SUBCASE("who searches") {
    REQUIRE(tracker->start_by_detection({}, options) == Status::ok);
  }
  SUBCASE("whose start fails, though the search before it would have had them") {
    REQUIRE(tracker->start_by_detection() == Status::ok);
    const NamedPoint one{"ibug30", {}};
    const NamedPoint points[] = {one, one, one, one, one};
    REQUIRE(tracker->start_from_landmarks(film().view(0), {points, 5}, {}, options) ==
            Status::underdetermined);
  }
  for (std::size_t k = 0; k < kFrames; ++k) update(tracker.object, film(), k);
  CHECK(fake.alignments > 1);
  BakedModel& face = baked_face();
  const Projector projector(tracker->estimator().view(), true);
  const Span<const float> q = tracker->parameters();
  for (const char* name : {"ibug30", "ibug57", "ibug36"}) {
    CAPTURE(name);
    Vec2 x, of_model;
    REQUIRE(tracker->landmark(name, &x) == Status::ok);
    REQUIRE(projector.project(face.at(name, {q.begin(), q.end()}), &of_model));
    CHECK(length(x - of_model) < 0.01f);
  }
}

TEST_CASE("a look takes a step in each frame once it has begun: the head may turn") {
  FakeFaces fake(film());
  InArena<Tracker> tracker(baked_face().model, limits_with_looks());
  const int of_start = fake.steps_an_alignment;
  std::size_t k = 0;
  while (fake.steps <= of_start) update(tracker.object, film(), k++);
  CHECK(k > kSecondLookTuning.first_wait);
  for (int step = 2; step <= of_start; ++step) {
    update(tracker.object, film(), k++);
    CHECK(fake.steps == of_start + step);
  }
}

TEST_CASE("a look begins with the roll of the head, as a search at that turn does") {
  for (const int eighths : {0, 2, 7}) {
    CAPTURE(eighths);
    const FaceFilm rolled(
        320, 240, 20,
        [&](float, Pose& pose, auto&) {
          pose.q = exp_rotation({0, 0, roll_of_turn(eighths) + 0.2f});
        },
        0.5f);
    FakeFaces fake(rolled);
    InArena<Tracker> tracker(baked_face().model, limits_with_looks());
    for (std::size_t k = 0; fake.alignments < 2 && k < 20; ++k) update(tracker.object, rolled, k);
    CHECK(fake.alignments == 2);
    CHECK(fake.roll == roll_of_turn(eighths));
  }
}

TEST_CASE("a look that cannot begin keeps no other work waiting") {
  int verifications[2];
  for (const bool is_blind : {false, true}) {
    FakeFaces fake(film());
    if (is_blind) fake.blind_from = 1;
    InArena<Tracker> tracker(baked_face().model, limits_with_looks());
    for (std::size_t k = 0; k < kFrames; ++k) update(tracker.object, film(), k);
    verifications[is_blind] = fake.verifications;
  }
  CHECK(verifications[true] >= verifications[false]);
}

TEST_CASE(
    "looks wait longer and longer while nothing is better, but not long after a start that was doubtful or "
    "turned") {
  const struct {
    std::string what;
    float turn, error;
    int alignments;  // the start, and looks that begin after 12, 24 and 48 more frames, or 12, 24, 24 and 24
  } kCases[] = {{"sure and frontal", 0, 0.02f, 4}, {"doubtful", 0, 0.035f, 5}, {"turned", 0.5f, 0.02f, 5}};
  for (const auto& c : kCases) {
    CAPTURE(c.what);
    const FaceFilm& turned = film(c.turn, c.turn, kLong);
    FakeFaces fake(turned);
    fake.error = c.error;
    InArena<Tracker> tracker(baked_face().model, limits_with_looks());
    for (std::size_t k = 0; k < kLong; ++k) update(tracker.object, turned, k);
    CHECK(fake.alignments == c.alignments);
  }
}

TEST_CASE("second looks cost memory only where the limits name them") {
  const TrackerLimits with = limits_with_looks(), without = limits_with_fake();
  FakeFaces fake(film());
  const std::size_t bytes = measured_bytes<Tracker>(baked_face().model, with),
                    plain = measured_bytes<Tracker>(baked_face().model, without);
  CHECK(bytes >= plain + FakeFaces::kAlignerBytes);
  CHECK(measured_bytes<Tracker>(baked_face().model, without_detection(with)) ==
        measured_bytes<Tracker>(baked_face().model, without_detection(without)));
  CHECK(profile_s().second_look == nullptr);
}

}  // namespace second_look_test
