// A mouth that opens as fast as in life. The jaw moves further in a frame than the tolerance of the depth buffer, and its
// points must not be taken as occluded by its old surface.
#include <doctest/doctest.h>

#include "face_film.hpp"
#include "model_builder.hpp"
#include "pliant/tracker.hpp"

namespace yawn_test {

using namespace pliant;

namespace {

constexpr std::size_t kFrames = 40, kOpens = 5, kOpen = 12, kCloses = 22, kClosed = 32;

float smooth(float x) {
  const float t = clamp(x, 0, 1);
  return t * t * (3 - 2 * t);
}

/// 0 shut, 1 open.
float opening(std::size_t k) {
  const auto part = [k](std::size_t from, std::size_t to) {
    return smooth((static_cast<float>(k) - static_cast<float>(from)) / static_cast<float>(to - from));
  };
  return part(kOpens, kOpen) * (1 - part(kCloses, kClosed));
}

FaceFilm yawn(float jaw) {
  return FaceFilm(320, 240, kFrames, [jaw](float s, Pose& pose, auto& q) {
    const float open = opening(static_cast<std::size_t>(s * (kFrames - 1) + 0.5f));
    pose.q = exp_rotation({0.05f * open, 0.05f * s, 0});
    FaceFilm::set(q, "jawOpen", jaw * open);
    FaceFilm::set(q, "mouthFunnel", 0.2f * open);
  });
}

/// Error of the mouth's height.
struct MouthError {
  float mean_px = 0, worst_px = 0;
};

MouthError track(const FaceFilm& film) {
  TrackerLimits limits;
  limits.curve_points = 96;
  limits.silhouette_points = 24;
  InArena<Tracker> tracker(baked_face().model, limits);
  REQUIRE(film.start_at_truth(tracker.object) == Status::ok);
  MouthError error;
  for (std::size_t k = 1; k < film.count(); ++k) {
    FrameResult result;
    REQUIRE(tracker->update(film.view(k), &result) == Status::ok);
    CHECK(result.state == TrackState::tracking);
    Vec2 upper, lower;
    REQUIRE(tracker->estimator().project(baked_face().uv("ibug51"), &upper));
    REQUIRE(tracker->estimator().project(baked_face().uv("ibug57"), &lower));
    const float off =
        magnitude(length(lower - upper) - length(film.truth("ibug57", k) - film.truth("ibug51", k)));
    error.mean_px += off / static_cast<float>(film.count() - 1);
    error.worst_px = max(error.worst_px, off);
  }
  return error;
}

}  // namespace

TEST_CASE("a mouth that opens wide in seven frames and closes again is tracked") {
  for (const float jaw : {0.25f, 0.32f, 0.4f}) {
    const MouthError error = track(yawn(jaw));
    MESSAGE("jaw " << jaw << ": mean error of the height of the mouth " << error.mean_px << " px, at worst "
                   << error.worst_px);
    CHECK(error.mean_px < 0.6f);
    CHECK(error.worst_px < 2.5f);
  }
}

}  // namespace yawn_test
