// What each cue adds to corners, on a face of which one half has no texture but outlines of what is darker and lighter:
// edges hold on to that half, and nothing is lost by following patches besides.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "face_film.hpp"
#include "model_builder.hpp"
#include "pliant/tracker.hpp"

using namespace pliant;

namespace {

constexpr std::size_t kUnique = 40, kTracked = 160;

/// A head that turns, nods, comes nearer and talks.
FaceFilm make_film(float flat_step_grey) {
  return FaceFilm(
      320, 240, kUnique,
      [](float s, Pose& pose, auto& q) {
        const float wave = std::sin(3.14159f * (s - 0.5f));
        pose.q = exp_rotation({0.1f * s, 0.4f * wave, 0.05f * wave});
        pose.t = pose.t + Vec3{20 * wave, 5 * s, -30 * s};
        FaceFilm::set(q, "jawOpen", 0.1f * (1 - std::cos(12.566f * s)));
        FaceFilm::set(q, "browInnerUpLeft", 0.8f * s * s);
        FaceFilm::set(q, "mouthSmileLeft", 0.3f * (1 + wave));
      },
      0.6f, flat_step_grey, 224);
}

/// Played to and fro.
std::size_t shown(std::size_t n) {
  const std::size_t m = n % (2 * kUnique - 2);
  return m < kUnique ? m : 2 * kUnique - 2 - m;
}

struct Error {
  float landmark_px = 0;  // mean
  float turn_deg = 0;     // median
};

/// Mean distance of all landmarks, those along the jaw too, from the truth of frame k.
float landmark_error(const FaceFilm& film, Tracker& tracker, std::size_t k) {
  const Span<const Landmark> landmarks = baked_face().model.landmarks();
  float sum = 0;
  for (const Landmark& l : landmarks) {
    Vec2 x;
    REQUIRE(tracker.estimator().project({l.u, l.v}, &x));
    sum += length(x - film.truth(l.name, k));
  }
  return sum / static_cast<float>(landmarks.count);
}

Error track(const FaceFilm& film, unsigned cues) {
  TrackerLimits limits;
  limits.curve_points = 96;
  limits.silhouette_points = 24;
  TrackerOptions options;
  options.estimator.cues = static_cast<std::uint8_t>(cues);
  InArena<Tracker> tracker(baked_face().model, limits);
  REQUIRE(tracker->start_from_pose(film.view(0), film.camera, film.poses[0], film.parameters[0].data(),
                                   options) == Status::ok);
  Error error;
  std::vector<float> turns;
  for (std::size_t n = 1; n <= kTracked; ++n) {
    FrameView view = film.view(shown(n));
    view.time_ns = static_cast<std::int64_t>(n) * 33'333'333;
    view.sequence = static_cast<std::uint32_t>(n);
    FrameResult result;
    REQUIRE(tracker->update(view, &result) == Status::ok);
    CHECK(result.state == TrackState::tracking);
    error.landmark_px += landmark_error(film, tracker.object, shown(n)) / kTracked;
    turns.push_back(film.turn_error(result.pose, shown(n)));
  }
  std::nth_element(turns.begin(), turns.begin() + kTracked / 2, turns.end());
  error.turn_deg = turns[kTracked / 2];
  return error;
}

constexpr unsigned bit(Cue cue) {
  return 1u << static_cast<unsigned>(cue);
}
constexpr unsigned kCorners = bit(Cue::patch), kEdges = bit(Cue::edge), kFlow = bit(Cue::flow);

}  // namespace

TEST_CASE(
    "on a face that is half without texture, edges improve on corners, and nothing is lost by all cues") {
  const FaceFilm film = make_film(64);
  const Error corners = track(film, kCorners), edges = track(film, kCorners | kEdges),
              flow = track(film, kCorners | kFlow), all = track(film, kCorners | kEdges | kFlow);
  for (const auto& [name, e] : {std::pair{"corners", corners}, std::pair{"corners, edges", edges},
                                std::pair{"corners, flow", flow}, std::pair{"all", all}})
    MESSAGE(std::string(name) << ": " << e.landmark_px << " px, " << e.turn_deg << " degrees");
  CHECK(edges.landmark_px < 0.97f * corners.landmark_px);
  CHECK(edges.turn_deg < 0.6f * corners.turn_deg);
  CHECK(flow.landmark_px < 1.07f * corners.landmark_px);  // a few percent are chance
  CHECK(flow.turn_deg < 1.15f * corners.turn_deg);
  CHECK(all.landmark_px < corners.landmark_px);
  CHECK(all.turn_deg < 0.6f * corners.turn_deg);
  CHECK(all.landmark_px < 1.1f * edges.landmark_px);
}
