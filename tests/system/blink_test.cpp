// Eyes that blink, in rendered films: the learnt readers of the eyes close the lids within the frame, and nowhere else.
#include <doctest/doctest.h>

#include "face_film.hpp"
#include "host/io/files.hpp"
#include "host/io/owned.hpp"
#include "pliant/tracker.hpp"

using namespace pliant;

namespace {

const host::ModelFile& face() {
  static const host::ModelFile* file = new host::ModelFile(PLIANT_DETECTING_FACE);
  return *file;
}

constexpr std::size_t kFrames = 48;
constexpr std::size_t kBlinks[] = {10, 30};  // first frame of each

/// 0 open, 1 shut: a blink takes seven frames.
float closing(std::size_t k) {
  constexpr float kWay[] = {0.4f, 0.9f, 1, 1, 0.8f, 0.5f, 0.2f};
  for (const std::size_t first : kBlinks)
    if (k >= first && k < first + 7) return kWay[k - first];
  return 0;
}

FaceFilm film(float blink) {
  return FaceFilm(320, 240, kFrames, [blink](float s, Pose& pose, auto& q) {
    pose.q = exp_rotation({0.04f * s, 0.1f * s, 0});
    const float closed = blink * closing(static_cast<std::size_t>(s * (kFrames - 1) + 0.5f));
    FaceFilm::set(q, "eyeBlinkLeft", closed);
    FaceFilm::set(q, "eyeBlinkRight", closed);
  });
}

/// eyeBlinkLeft and Right of each frame.
std::vector<Vec2> track(const FaceFilm& film) {
  host::Owned<Tracker> tracker(face().model(), TrackerLimits{});
  REQUIRE(tracker->start_from_pose(film.view(0), film.camera, film.poses[0], film.parameters[0].data()) ==
          Status::ok);
  std::vector<Vec2> lids(1);
  for (std::size_t k = 1; k < film.count(); ++k) {
    FrameResult result;
    REQUIRE(tracker->update(film.view(k), &result) == Status::ok);
    CHECK(result.state == TrackState::tracking);
    Vec2 x;
    REQUIRE(tracker->parameter("eyeBlinkLeft", &x.x) == Status::ok);
    REQUIRE(tracker->parameter("eyeBlinkRight", &x.y) == Status::ok);
    lids.push_back(x);
  }
  return lids;
}

}  // namespace

TEST_CASE("lids close within two frames of a blink and open after it") {
  const std::vector<Vec2> lids = track(film(1));
  for (const std::size_t first : kBlinks)
    for (const auto eye : {&Vec2::x, &Vec2::y}) {
      CHECK(lids[first + 3].*eye > 0.5f);
      CHECK(lids[first - 2].*eye < 0.35f);
      CHECK(lids[first + 11].*eye < 0.35f);
    }
}

TEST_CASE("lids that do not blink stay open") {
  for (const Vec2 lid : track(film(0))) {
    CHECK(lid.x < 0.4f);
    CHECK(lid.y < 0.4f);
  }
}
