// Starts from a saved state where the face has moved since. Detection and alignment are a fake that knows the truth.
#include <doctest/doctest.h>

#include <vector>

#include "fake_faces.hpp"
#include "model_builder.hpp"
#include "track/second_look.hpp"

namespace resume_test {

using namespace pliant;

namespace {

constexpr std::size_t kFrames = 40, kSaved = 10;

/// A face that moves by a sixth of the distance of its eyes in ten frames.
const FaceFilm& film() {
  static const FaceFilm* made = new FaceFilm(
      320, 240, kFrames,
      [](float s, Pose& pose, auto& q) {
        FaceFilm::set(q, "faceWidth", 1.5f);
        pose.t.x += 60 * s - 30;
      },
      0.5f);
  return *made;
}

struct Saved {
  std::vector<float> q;
  std::vector<Vec3> offsets;
  SavedState state;
};

/// The state of a track after frame kSaved, with an offset that the caller has placed.
Saved saved(float lower_px) {
  Saved result;
  const Model& model = baked_face().model;
  result.q.resize(model.parameters().count);
  result.offsets.resize(model.landmarks().count);
  result.state.parameters = {result.q.data(), result.q.size()};
  result.state.landmark_offsets = {result.offsets.data(), result.offsets.size()};
  InArena<Tracker> tracker(model, limits_with_looks());
  for (std::size_t k = 0; k <= kSaved; ++k) update(tracker.object, film(), k);
  const NamedPoint point{"ibug30", film().truth("ibug30", kSaved) + Vec2{0, lower_px}};
  REQUIRE(tracker->place_landmarks({&point, 1}) == Status::ok);
  REQUIRE(tracker->save(&result.state) == Status::ok);
  return result;
}

/// Where a tracker that resumes in frame k has a landmark, less its truth, at the end of the film.
Vec2 error_after_resuming(const TrackerLimits& limits, const Saved& saved, std::size_t k, const char* name) {
  InArena<Tracker> tracker(baked_face().model, limits);
  REQUIRE(tracker->start_from_state(film().view(k), saved.state) == Status::ok);
  CHECK(tracker->track_number() == 1);
  CHECK(tracker->person_number() == 1);
  while (++k < kFrames) update(tracker.object, film(), k);
  float width;
  REQUIRE(tracker->parameter("faceWidth", &width) == Status::ok);
  CHECK(width == saved.q[baked_face().model.find_parameter("faceWidth")]);
  Vec2 x;
  REQUIRE(tracker->landmark(name, &x) == Status::ok);
  return x - film().truth(name, kFrames - 1);
}

}  // namespace

TEST_CASE(
    "a track that is resumed where the face has moved since is at the face, with the saved person and "
    "offsets") {
  FakeFaces fake(film());
  const Saved before = saved(7);
  constexpr std::size_t kLater = kSaved + 10;
  CHECK(length(error_after_resuming(limits_with_looks(), before, kLater, "ibug36")) < 1.5f);
  const Vec2 placed = error_after_resuming(limits_with_looks(), before, kLater, "ibug30");
  CHECK(length(placed - Vec2{0, 7}) < 1.5f);
  // Without second looks the templates are captured beside the face, and stay there.
  CHECK(length(error_after_resuming(limits_with_fake(), before, kLater, "ibug36")) > 5);
}

TEST_CASE("a resumed track that moves to the face keeps the saved values of parameters that are not free") {
  FaceFilm speaking = film();
  FakeFaces fake(speaking);
  const Saved before = saved(0);
  const std::size_t jaw = baked_face().model.find_parameter("jawOpen");
  std::vector<std::uint8_t> is_free(before.q.size(), 1);
  TrackerOptions options;
  options.is_free = is_free.data();
  for (std::vector<float>& q : speaking.parameters) q[jaw] = 0.3f;
  for (const bool is_held : {false, true}) {
    is_free[jaw] = !is_held;
    InArena<Tracker> tracker(baked_face().model, limits_with_looks());
    REQUIRE(tracker->start_from_state(speaking.view(kSaved + 10), before.state, options) == Status::ok);
    CHECK(length(tracker->result().pose.t - before.state.pose.t) > 5);  // it has moved
    CHECK(tracker->parameters()[jaw] == (is_held ? before.q[jaw] : 0.3f));
  }
}

TEST_CASE(
    "a track that is resumed stays where it was saved for a caller who places markers, or a face that has "
    "not moved") {
  FakeFaces fake(film());
  const Saved before = saved(0);
  TrackerLimits limits = limits_with_looks();
  limits.markers = 1;
  const Vec2 marker = film().truth("ibug30", kSaved);
  for (const bool has_marker : {true, false}) {
    InArena<Tracker> tracker(baked_face().model, limits);
    const std::size_t k = has_marker ? kSaved + 10 : kSaved;
    REQUIRE(tracker->start_from_state(film().view(k), before.state, {}, {&marker, has_marker}) == Status::ok);
    CHECK(length(tracker->result().pose.t - before.state.pose.t) == 0);
  }
}

TEST_CASE("a track that is resumed where no alignment is sure begins where it was saved") {
  FakeFaces fake(film());
  const Saved before = saved(0);
  fake.held_error = kFaceChecksTuning.most_landmark_error + 0.01f;
  CHECK(length(error_after_resuming(limits_with_looks(), before, kSaved + 10, "ibug36")) > 5);
}

}  // namespace resume_test
