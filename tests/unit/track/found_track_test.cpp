// What comes after a track that has begun while another one ended. Detection and alignment are a fake that knows the truth.
#include "track/found_track.hpp"

#include <doctest/doctest.h>

#include "fake_faces.hpp"
#include "model_builder.hpp"
#include "track/realignment.hpp"

namespace found_track_test {

using namespace pliant;

namespace {

constexpr std::size_t kFrames = 60;

const FaceFilm& film() {
  static const FaceFilm* one = new FaceFilm(drifting_face(kFrames));
  return *one;
}

}  // namespace

TEST_CASE(
    "after a track that has begun anew, a start of the caller's takes all its templates, from its own "
    "picture") {
  FakeFaces fake(film());
  fake.covered_frames = 10;
  InArena<Tracker> tracker(baked_face().model, limits_with_looks()),
      first(baked_face().model, limits_with_looks());
  std::size_t k = 0;
  for (; k < kFrames && (k == 0 || tracker->track_number() < 2); ++k) update(tracker.object, film(), k);
  REQUIRE(k < kFrames);
  for (const std::size_t end = k + 4; k < end; ++k)
    update(tracker.object, film(), k);  // it has all its templates
  // Of another place, so that the picture that the tracker has is another one.
  FrameView view = film().view(0);
  FrameResult result[2];
  for (Tracker* each : {&tracker.object, &first.object})
    REQUIRE(each->start_from_pose(view, film().camera, film().poses[0], baked_face().rest().data(), {}) ==
            Status::ok);
  CHECK(tracker->result().tracked == first->result().tracked);
  CHECK(tracker->result().tracked > limits_with_looks().patches / 2);
  view = film().view(1);
  REQUIRE(tracker->update(view, &result[0]) == Status::ok);
  REQUIRE(first->update(view, &result[1]) == Status::ok);
  CHECK(result[0].tracked == result[1].tracked);
  CHECK(result[0].pose.t.x == result[1].pose.t.x);
  CHECK(result[0].pose.t.z == result[1].pose.t.z);
  CHECK(result[0].rms_px == result[1].rms_px);
}

TEST_CASE("a new track takes its other templates and its edges from good frames, not from aligned ones") {
  std::size_t begun = kFrames;  // the first frame of that track
  // \param first, aligned  frames of that track whose picture is a negative, which no template matches.
  const auto inliers_after = [&](std::size_t first, std::size_t aligned) {
    FakeFaces fake(film());
    fake.covered_frames = 10;
    InArena<Tracker> tracker(baked_face().model, limits_with_looks());
    FrameResult result;
    for (std::size_t k = 0; k < kFrames && k < begun + first + aligned + 6; ++k) {
      std::vector<std::uint8_t> pixels = film().frames[k];
      if (k >= begun + first && k < begun + first + aligned)
        for (std::uint8_t& grey : pixels) grey = static_cast<std::uint8_t>(255 - grey);
      FrameView view = film().view(k);
      view.data = pixels.data();
      REQUIRE(tracker->update(view, &result) == Status::ok);
      CHECK(result.state == TrackState::tracking);
      if (begun == kFrames && tracker->track_number() == 2) begun = k;
    }
    CHECK(tracker->track_number() == 2);
    return static_cast<float>(result.inliers);
  };
  const float usual = inliers_after(0, 0);
  REQUIRE(begun + 12 < kFrames);
  for (const std::size_t first : {0u, 1u, 2u})
    for (const std::size_t aligned : {1u, 3u}) {
      CAPTURE(first);
      CAPTURE(aligned);
      CHECK(inliers_after(first, aligned) > 0.9f * usual);
    }
}

TEST_CASE(
    "a track of another person that begins anew keeps the mesh: to refine it takes as long as two frames") {
  constexpr std::size_t kChange = 10;
  FaceFilm other(
      320, 240, kFrames,
      [](float s, Pose& pose, auto& q) {
        pose.t.x += 20 * s;
        FaceFilm::set(q, s * (kFrames - 1) < kChange - 0.5f ? "faceWidth" : "noseLength", 3);
      },
      0.5f);
  for (std::size_t k = kChange; k < kFrames; ++k)
    for (std::uint8_t& grey : other.frames[k]) grey = static_cast<std::uint8_t>(255 - grey);
  FakeFaces fake(other);
  InArena<Tracker> tracker(baked_face().model, limits_with_looks());
  const auto places = [&] {
    std::vector<float> all;
    const Mesh& mesh = tracker->estimator().mesh();
    for (VertexId v : mesh.vertices()) all.insert(all.end(), {mesh.uv(v).x, mesh.uv(v).y});
    return all;
  };
  std::vector<float> before;
  for (std::size_t k = 0; k < kFrames && tracker->track_number() < 2; ++k) {
    update(tracker.object, other, k);
    if (k == 0) before = places();
  }
  REQUIRE(tracker->track_number() == 2);
  REQUIRE(tracker->person_number() == 2);
  CHECK(places() == before);
}

TEST_CASE("aligned frames begin no new track, however many there are, where good ones come between them") {
  FakeFaces fake(film());
  InArena<Tracker> tracker(baked_face().model, limits_with_looks());
  for (std::size_t k = 0; k < kFrames; ++k) {
    std::vector<std::uint8_t> pixels = film().frames[k];
    if (k >= 10 && k % 3 != 0)
      for (std::uint8_t& grey : pixels) grey = static_cast<std::uint8_t>(255 - grey);
    FrameView view = film().view(k);
    view.data = pixels.data();
    FrameResult result;
    REQUIRE(tracker->update(view, &result) == Status::ok);
    CHECK(result.state == TrackState::tracking);
  }
  CHECK(fake.refinements > kRealignmentTuning.most_frames);
  CHECK(tracker->track_number() == 1);
}

TEST_CASE("a new track that cannot begin leaves nothing to the search after it") {
  FakeFaces fake(film());
  fake.covered_frames = 10;
  fake.restless_px = 200;  // the second look has the face outside of the frame
  InArena<Tracker> tracker(baked_face().model, limits_with_looks());
  std::size_t k = 0;
  for (; fake.steps < 2 * fake.steps_an_alignment; ++k) {
    REQUIRE(k < kFrames - 10);
    CHECK_FALSE(update(tracker.object, film(), k).is_searching);
  }
  fake.blind_from = 0;
  for (const std::size_t end = k + 4; k < end; ++k) CHECK(update(tracker.object, film(), k).is_searching);
  fake.blind_from = kFrames;
  fake.restless_px = 0;
  const FrameResult result = update(tracker.object, film(), k);
  CHECK(result.state == TrackState::tracking);
  CHECK(result.inliers > limits_with_looks().patches / 2);
  CHECK(tracker->track_number() == 2);
}

TEST_CASE("a track that begins anew is the same whatever the origin of time") {
  constexpr std::size_t kChange = 12;
  // \param is_covered  a second look begins the track; else bad frames in a row, whose picture is a negative.
  const auto poses_at = [](bool is_covered, std::int64_t origin_ns) {
    FakeFaces fake(film());
    fake.covered_frames = is_covered ? 10 : 0;
    InArena<Tracker> tracker(baked_face().model, limits_with_looks());
    std::vector<float> poses;
    for (std::size_t k = 0; k < kFrames; ++k) {
      std::vector<std::uint8_t> pixels = film().frames[k];
      if (!is_covered && k >= kChange)
        for (std::uint8_t& grey : pixels) grey = static_cast<std::uint8_t>(255 - grey);
      FrameView view = film().view(k);
      view.data = pixels.data();
      view.time_ns += origin_ns;
      FrameResult result;
      REQUIRE(tracker->update(view, &result) == Status::ok);
      poses.insert(poses.end(), {result.pose.t.x, result.pose.t.y, result.pose.t.z, result.pose.q.x});
    }
    CHECK(tracker->track_number() == 2);
    return poses;
  };
  for (const bool is_covered : {true, false}) {
    const std::vector<float> poses = poses_at(is_covered, 0);
    for (const std::size_t frames : {20u, 1000u})
      CHECK(poses_at(is_covered, film().view(1).time_ns * -static_cast<std::int64_t>(frames)) == poses);
  }
}

}  // namespace found_track_test
