// What each cue adds to templates, on a face of which one half has no texture but the contours of what is darker and
// lighter: edges hold that half.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "face_film.hpp"
#include "model_builder.hpp"
#include "pliant/tracker.hpp"

namespace cue_order_test {

using namespace pliant;

namespace {

constexpr std::size_t kUnique = 40, kTracked = 2 * kUnique - 2;  // to and fro, once

/// A head that turns, nods, comes nearer and talks; backwards in time for an odd seed, so that another view is frame 0.
FaceFilm make_film(std::uint32_t seed) {
  return FaceFilm(
      320, 240, kUnique,
      [seed](float time, Pose& pose, auto& q) {
        const float s = seed % 2 == 1 ? 1 - time : time;
        const float wave = std::sin(3.14159f * (s - 0.5f));
        pose.q = exp_rotation({0.1f * s, 0.4f * wave, 0.05f * wave});
        pose.t = pose.t + Vec3{20 * wave, 5 * s, -30 * s};
        FaceFilm::set(q, "jawOpen", 0.1f * (1 - std::cos(12.566f * s)));
        FaceFilm::set(q, "browInnerUpLeft", 0.8f * s * s);
        FaceFilm::set(q, "mouthSmileLeft", 0.3f * (1 + wave));
      },
      0.6f, 64, 160, seed);
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
    REQUIRE(tracker.estimator().project(l.uv(), &x));
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
  REQUIRE(film.start_at_truth(tracker.object, 0, options) == Status::ok);
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

void add(const Error& one, Error* sum) {
  sum->landmark_px += one.landmark_px;
  sum->turn_deg += one.turn_deg;
}

constexpr unsigned bit(Cue cue) {
  return 1u << static_cast<unsigned>(cue);
}
constexpr unsigned kTemplates = bit(Cue::patch), kEdges = bit(Cue::edge), kFlow = bit(Cue::flow);

}  // namespace

// Sums over twelve films, because a few films' ratios move by several percent with any change of sampling. Measured ratios of
// rotation errors to those of templates alone: 0.84 with edges, 0.80 with all cues. Each bound is half way from the measured ratio
// to no effect. Before templates allowed for ramps of light these were 0.58 and 0.52, of errors that were larger; landmarks had
// 0.91 with all cues, and now have 0.98 with edges and 1.02 with all: of them nothing is claimed. What frame-to-frame tracking is
// for shows on recorded faces (docs/evaluation.md, Recorded face).
TEST_CASE("on a face half without texture edges improve rotation, and so do all cues together") {
  Error templates, edges, flow, all;
  for (std::uint32_t seed = 0; seed < 12; ++seed) {
    const FaceFilm film = make_film(seed);
    add(track(film, kTemplates), &templates);
    add(track(film, kTemplates | kEdges), &edges);
    if (seed < 2) add(track(film, kTemplates | kFlow), &flow);  // only that it tracks
    add(track(film, kTemplates | kEdges | kFlow), &all);
  }
  for (const auto& [name, e] : {std::pair{"templates", templates}, std::pair{"templates, edges", edges},
                                std::pair{"templates, frame to frame, of two films", flow}, std::pair{"all", all}})
    MESSAGE(std::string(name) << ": " << e.landmark_px << " px, " << e.turn_deg << " degrees");
  CHECK(edges.turn_deg < 0.92f * templates.turn_deg);
  CHECK(all.turn_deg < 0.90f * templates.turn_deg);
}

}  // namespace cue_order_test
