// Frames in low light, whose noise is as large as what templates and detector compare.
#include <doctest/doctest.h>

#include "fake_faces.hpp"
#include "open_model.hpp"
#include "pliant/tracker.hpp"
#include "vision/noise.hpp"
#include "vision/noise_tuning.hpp"

namespace low_light_test {

using namespace pliant;

namespace {

constexpr int kWidth = 320, kHeight = 240;
constexpr std::size_t kFrames = 24;

/// A head that turns a little and talks, at a fraction of its light.
FaceFilm film_at(float light, float noise) {
  FaceFilm film(kWidth, kHeight, kFrames, [](float s, Pose& pose, std::vector<float>& q) {
    pose.q = exp_rotation({0, 0.2f * s, 0});
    FaceFilm::set(q, "jawOpen", 0.2f * s);
  });
  for (std::size_t k = 0; k < kFrames; ++k) {
    Picture dark(kWidth, kHeight);
    for (std::size_t i = 0; i < dark.pixels.size(); ++i)
      dark.pixels[i] = static_cast<std::uint8_t>(10 + light * static_cast<float>(film.frames[k][i]));
    add_noise(dark, noise, 50 + static_cast<std::uint32_t>(k));
    film.frames[k] = dark.pixels;
  }
  return film;
}

/// Frames in state tracking within 3 degrees, of those behind the first.
int frames_right(Tracker& tracker, const FaceFilm& film) {
  int right = 0;
  for (std::size_t k = 1; k < kFrames; ++k) {
    FrameResult result;
    REQUIRE(tracker.update(film.view(k), &result) == Status::ok);
    right += result.state == TrackState::tracking && film.turn_error(result.pose, k) < 3;
  }
  return right;
}

/// The same after a start at the true pose.
int frames_right(const TrackerLimits& limits, const FaceFilm& film) {
  InArena<Tracker> tracker(baked_face().model, limits);
  REQUIRE(film.start_at_truth(tracker.object) == Status::ok);
  return frames_right(tracker.object, film);
}

}  // namespace

TEST_CASE("a face in low light is tracked, since its frames are smoothed") {
  const FaceFilm film = film_at(0.25f, 12);
  const TrackerLimits limits = without_detection(TrackerLimits{});
  CHECK(frames_right(limits, film) >= 22);
  CHECK(frames_right(without_noise_smoothing(limits), film) <= 8);
}

TEST_CASE("the bits of a film without much noise are the same with smoothing and without") {
  const FaceFilm film = film_at(0.9f, 1);
  const TrackerLimits limits = without_detection(TrackerLimits{});
  InArena<Tracker> smoothing(baked_face().model, limits),
      plain(baked_face().model, without_noise_smoothing(limits));
  for (Tracker* t : {&smoothing.object, &plain.object}) REQUIRE(film.start_at_truth(*t) == Status::ok);
  for (std::size_t k = 1; k < kFrames; ++k) {
    FrameResult a, b;
    REQUIRE(smoothing->update(film.view(k), &a) == Status::ok);
    REQUIRE(plain->update(film.view(k), &b) == Status::ok);
    CHECK((a.pose.t.x == b.pose.t.x && a.pose.q.y == b.pose.q.y && a.tracked == b.tracked));
  }
}

TEST_CASE("a start from landmarks smooths its frame, too") {
  const FaceFilm film = film_at(0.25f, 12);
  const TrackerLimits limits = without_detection(TrackerLimits{});
  std::vector<NamedPoint> points;
  std::vector<std::string> names;
  for (int k = 17; k < 68; ++k) names.push_back("ibug" + std::to_string(k));
  for (const std::string& name : names) points.push_back({name.c_str(), film.truth(name, 0)});
  InArena<Tracker> tracker(baked_face().model, limits);
  REQUIRE(tracker->start_from_landmarks(film.view(0), {points.data(), points.size()}) == Status::ok);
  CHECK(frames_right(tracker.object, film) >= 20);
}

TEST_CASE("a start by detection is in a frame that is smoothed, too") {
  const FaceFilm film = film_at(0.25f, 12);
  FakeFaces fake(film);
  InArena<Tracker> tracker(baked_face().model, limits_with_fake());
  FrameResult first;
  REQUIRE(tracker->update(film.view(0), &first) == Status::ok);
  REQUIRE(tracker->is_started());
  CHECK(frames_right(tracker.object, film) >= 22);
}

TEST_CASE("a start after noisy frames gives the bits of a first start") {
  const FaceFilm dark = film_at(0.25f, 12), doubtful = film_at(0.8f, 9.4f);
  const FrameNoise of = noise_of(doubtful.view(0));
  REQUIRE(of.noise <
          kNoiseTuning.noisy * of.contrast);  // smoothed after a noisy frame, but not as the first one
  REQUIRE(of.noise > kNoiseTuning.still_noisy * of.contrast);
  FakeFaces fake(doubtful);
  const FrameView first = doubtful.view(0), second = doubtful.view(1);
  const auto from_pose = [&](Tracker& t) {
    return t.start_from_pose(first, doubtful.camera, doubtful.poses[0], doubtful.parameters[0].data());
  };
  const auto from_box = [&](Tracker& t) {
    const FaceBox box = fake.box(0);
    StartOptions options;
    options.box = BoxConvention::face_box;
    return t.start_from_box(first, box.center - Vec2{0.5f * box.side, 0.5f * box.side}, {box.side, box.side},
                            options);
  };
  const auto by_detection = [&](Tracker& t) {
    FrameResult result;
    const Status status = t.start_by_detection();
    return status == Status::ok ? t.update(first, &result) : status;
  };
  const std::function<Status(Tracker&)> starts[] = {from_pose, from_box, by_detection};
  for (const auto& start : starts) {
    InArena<Tracker> used(baked_face().model, limits_with_fake()),
        fresh(baked_face().model, limits_with_fake());
    FrameResult a, b;
    REQUIRE(used->update(dark.view(0), &a) == Status::ok);
    REQUIRE(start(used.object) == Status::ok);
    REQUIRE(start(fresh.object) == Status::ok);
    REQUIRE(used->update(second, &a) == Status::ok);
    REQUIRE(fresh->update(second, &b) == Status::ok);
    CHECK((a.pose.t.x == b.pose.t.x && a.pose.q.y == b.pose.q.y && a.rms_px == b.rms_px));
  }
}

TEST_CASE("the model of a surface that is no face has no filter") {
  const auto bytes = [](const Model& model, const TrackerLimits& limits) {
    return measured_bytes<Tracker>(model, limits);
  };
  const TrackerLimits limits, plain = without_noise_smoothing(limits);
  CHECK(bytes(baked_face().model, limits) - bytes(baked_face().model, plain) >= 320 * 250);
  const OpenedEgg egg(2);
  CHECK(bytes(egg.model, limits) == bytes(egg.model, plain));
}

}  // namespace low_light_test
