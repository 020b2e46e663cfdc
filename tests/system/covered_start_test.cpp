// A start that a cup covers, with the learnt tables of the built-in face: what is right once the cup is gone.
#include <doctest/doctest.h>

#include "host/bench/annotated_faces.hpp"
#include "host/bench/still_film.hpp"
#include "host/io/files.hpp"
#include "host/io/points_file.hpp"
#include "model_builder.hpp"
#include "pliant/tracker.hpp"

using namespace pliant;
using namespace pliant::host;

namespace {

const std::string kAstronaut = PLIANT_FIXTURES "/astronaut";
constexpr float kScale = 0.5f;
constexpr std::size_t kCovered = 20, kFrames = 110;

/// The photograph with a cup before mouth and chin. \param eyes  distance of the outer eye corners, px.
Image with_cup(const Image& picture, const NamedLandmarks& at) {
  Image covered = picture;
  const float eyes = eye_distance(at);
  const Vec2 mouth = 0.5f * (at.at("ibug48") + at.at("ibug54"));
  for (int j = static_cast<int>(mouth.y - 0.2f * eyes); j < static_cast<int>(mouth.y + 0.9f * eyes); ++j)
    for (int i = static_cast<int>(mouth.x - 0.4f * eyes); i < static_cast<int>(mouth.x + 0.3f * eyes); ++i)
      if (covered.contains(i, j)) *covered.at(i, j) = static_cast<std::uint8_t>(120 + (i + j) % 7);
  return covered;
}

/// Landmark error of the last frame, fraction of the eyes' distance, of a tracker that starts by itself.
double error_at_the_end(const TrackerLimits& limits_of, const Image& picture, const Image& covered,
                        const NamedLandmarks& truth) {
  static const ModelFile face(PLIANT_DETECTING_FACE);
  TrackerLimits limits = limits_of;
  limits.width = static_cast<std::uint16_t>(picture.width);
  limits.height = static_cast<std::uint16_t>(picture.height);
  InArena<Tracker> tracker(face.model(), limits);
  StillFilm before(covered), after(picture);
  for (std::size_t k = 0; k < kFrames; ++k) {
    FrameResult result;
    REQUIRE(tracker->update((k < kCovered ? before : after).frame(k), &result) == Status::ok);
    CHECK(result.state != TrackState::lost);
  }
  NamedLandmarks found;
  for (std::size_t l = 0; l < face.model().landmarks().count; ++l)
    REQUIRE(tracker->landmark(l, &found[face.model().landmarks()[l].name]) == Status::ok);
  return landmark_error(found, moved(truth, 1, after.shift(kFrames - 1)));
}

}  // namespace

TEST_CASE("a face that a cup covered at the start is aligned anew once the cup is gone") {
  const Image picture = resized(to_grey(read_image(kAstronaut + "/astronaut.png")), kScale);
  NamedLandmarks truth;
  for (const host::NamedPoint& p : read_points(kAstronaut + "/points.csv")) truth[p.name] = p.x;
  truth = moved(truth, kScale, {0, 0});
  const Image covered = with_cup(picture, truth);
  const double free = error_at_the_end({}, picture, picture, truth),
               looking = error_at_the_end({}, picture, covered, truth),
               as_started = error_at_the_end(without_second_look({}), picture, covered, truth);
  MESSAGE("free " << free << ", covered at first " << looking << ", without a second look " << as_started);
  CHECK(looking < 1.1 * free + 0.002);
  CHECK(as_started > 1.3 * free);
}
