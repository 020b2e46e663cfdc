// Tracks that begin in light that hides most of the face. Detection and alignment are a fake that knows the truth.
#include "track/poor_start.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "fake_faces.hpp"
#include "model_builder.hpp"

namespace poor_start_test {

using namespace pliant;

namespace {

constexpr int kWidth = 320, kHeight = 240;
constexpr std::size_t kFrames = 40;

const FaceFilm& film() {
  static const FaceFilm* made = new FaceFilm(drifting_face(kFrames));
  return *made;
}

/// Light of the frames, by number.
using Light = float (*)(std::size_t k);

/// Runs a tracker that starts by itself on the film in this light. \return templates and edge points found, by frame; 0: no track.
/// \param error  that alignments estimate.
std::vector<int> found_in(Light light, int* searches, float error = kPoorStartTuning.most_sure_error) {
  FakeFaces fake(film());
  fake.error = error;
  TrackerLimits limits;
  limits.detection = FakeFaces::table();
  InArena<Tracker> tracker(baked_face().model, limits);
  std::vector<int> found;
  for (std::size_t k = 0; k < kFrames; ++k) {
    std::vector<std::uint8_t> lit = film().frames[k];
    for (std::uint8_t& p : lit) p = static_cast<std::uint8_t>(std::min(255.0f, light(k) * p));
    FrameView view = film().view(k);
    view.data = lit.data();
    FrameResult result;
    REQUIRE(tracker->update(view, &result) == Status::ok);
    found.push_back(tracker->is_started() ? result.tracked : 0);
    // Where light hides the face from the start on, the alignments have to be sure.
    const bool is_sure = error <= kPoorStartTuning.most_sure_error;
    if (light(0) > 2 && light(k) > 2) CHECK((result.state == TrackState::tracking) == is_sure);
  }
  *searches = fake.searches;
  return found;
}

}  // namespace

TEST_CASE("a track that began in light which hid most of the face begins anew when the light has changed") {
  int searches = 0;
  const auto found = found_in([](std::size_t k) { return k < 20 ? 2.4f : 1.0f; }, &searches);
  CAPTURE(found);
  const auto few = static_cast<int>(kPoorStartTuning.few_templates * TrackerLimits{}.patches);
  CHECK(found[0] > 0);
  CHECK(found[0] < few);
  CHECK(found[30] > 3 * few);
  CHECK(searches == 2);
}

TEST_CASE("light that hid the face and settles, or pulses, is over though the mean grey changes little") {
  InArena<Tracker> tracker(baked_face().model, TrackerLimits{});
  REQUIRE(film().start_at_pose(tracker.object) == Status::ok);
  Estimator& estimator = tracker->estimator();
  const auto in_light = [](float light) {
    std::vector<std::uint8_t> lit = film().frames[0];
    for (std::uint8_t& p : lit) p = static_cast<std::uint8_t>(std::min(255.0f, light * p));
    return lit;
  };
  const auto view_in = [](const std::vector<std::uint8_t>& lit) {
    FrameView view = film().view(0);
    view.data = lit.data();
    return view;
  };
  const auto blinding = in_light(4), settled = in_light(2.4f);
  PoorStart start;
  const auto frames_until_over = [&](int period) {
    start.begin(0, 100, view_in(blinding), estimator);
    REQUIRE(start.is_blinded());
    int k = 1;
    while (k < 100 && !start.is_over(view_in(k % period == 0 ? settled : blinding), estimator)) ++k;
    return k;
  };
  constexpr int kInterval = int{kPoorStartTuning.interval_frames}, kEnough = kPoorStartTuning.measurements;
  CHECK(frames_until_over(1) == kInterval * kEnough);
  CHECK(frames_until_over(3 * kInterval) == 3 * kInterval * kEnough);
  CHECK(frames_until_over(1000) == 100);
}

TEST_CASE("light that stays as it was at a poor start, or flashes, begins no track anew") {
  int searches = 0;
  for (const float factor : {1.0f, 1.01f}) {
    found_in([](std::size_t) { return 2.4f; }, &searches, factor * kPoorStartTuning.most_sure_error);
    CHECK(searches == 1);
  }
  found_in([](std::size_t k) { return k % 10 == 8 ? 1.0f : 2.4f; }, &searches);
  CHECK(searches == 1);
}

TEST_CASE("a start that saw enough goes through every light") {
  int searches = 0;
  const auto found = found_in([](std::size_t k) { return k < 10 ? 1.0f : k < 20 ? 0.5f : 1.3f; }, &searches);
  CHECK(searches == 1);
  CHECK(*std::min_element(found.begin(), found.end()) > 30);
}

TEST_CASE("poor starts: the bound itself, and a face outside of the frame") {
  InArena<Tracker> tracker(baked_face().model, TrackerLimits{});
  REQUIRE(film().start_at_pose(tracker.object) == Status::ok);
  Estimator& estimator = tracker->estimator();
  const auto few = static_cast<std::size_t>(100 * kPoorStartTuning.few_templates);
  PoorStart start;
  CHECK_FALSE(start.is_poor());
  start.begin(few, 100, film().view(0), estimator);
  CHECK_FALSE(start.is_poor());
  start.begin(few - 1, 100, film().view(0), estimator);
  CHECK(start.is_poor());
  CHECK_FALSE(start.is_blinded());
  CHECK_FALSE(start.is_doubtful(0));
  const std::vector<std::uint8_t> white(320 * 240, 255);
  FrameView bright = film().view(0);
  bright.data = white.data();
  start.begin(few, 100, bright, estimator);
  CHECK_FALSE(start.is_blinded());
  start.begin(few - 1, 100, bright, estimator);
  CHECK(start.is_blinded());
  CHECK(start.is_doubtful(0));  // unknown
  CHECK_FALSE(start.is_doubtful(kPoorStartTuning.most_sure_error));
  // The change of light must last, and counts from the last start on.
  constexpr int kEnough = int{kPoorStartTuning.interval_frames} * kPoorStartTuning.measurements;
  for (int again = 0; again < 2; ++again) {
    start.begin(few - 1, 100, bright, estimator);
    for (int k = 1; k < kEnough; ++k) CHECK_FALSE(start.is_over(film().view(0), estimator));
  }
  CHECK(start.is_over(film().view(0), estimator));
  const std::uint8_t pixel = 0;  // the landmarks are outside of this frame: nothing tells light
  const FrameView tiny = view_of_pixels({pixel}, 1, 1, 0);
  start.begin(0, 100, tiny, estimator);
  for (int k = 0; k < 20; ++k) CHECK_FALSE(start.is_over(film().view(0), estimator));
  start.begin(0, 100, film().view(0), estimator);
  for (int k = 0; k < 20; ++k) CHECK_FALSE(start.is_over(tiny, estimator));
}

TEST_CASE(
    "light has changed where the face is brighter or darker by more than noise in the dark is, however it is "
    "stored") {
  InArena<Tracker> tracker(baked_face().model, TrackerLimits{});
  REQUIRE(film().start_at_pose(tracker.object) == Status::ok);
  Estimator& estimator = tracker->estimator();
  // \param beside  in memory between the pixels, and behind a row.
  const auto is_over_after = [&](int grey, int later, std::uint8_t beside) {
    std::vector<std::uint8_t> pixels[2];
    FrameView views[2];
    for (int i = 0; i < 2; ++i) {
      pixels[i].assign(std::size_t{2 * kWidth + 11} * kHeight, beside);
      for (std::size_t y = 0; y < kHeight; ++y)
        for (std::size_t x = 0; x < kWidth; ++x)
          pixels[i][y * (2 * kWidth + 11) + 2 * x] = static_cast<std::uint8_t>(i == 0 ? grey : later);
      views[i] = film().view(0);
      views[i].data = pixels[i].data();
      views[i].stride_bytes = 2 * kWidth + 11;
      views[i].pixel_step_bytes = 2;
    }
    PoorStart start;
    start.begin(0, 100, views[0], estimator);
    CHECK(start.is_blinded() == (grey >= kPoorStartTuning.clipped_grey));
    int k = 1;
    while (k < 30 && !start.is_over(views[1], estimator)) ++k;
    return k < 30;
  };
  for (const std::uint8_t beside : {std::uint8_t{0}, std::uint8_t{255}}) {
    CHECK(is_over_after(50, 100, beside));
    CHECK(is_over_after(100, 50, beside));
    CHECK_FALSE(is_over_after(100, 100, beside));
    CHECK_FALSE(is_over_after(5, 10, beside));
    CHECK_FALSE(is_over_after(10, 5, beside));
  }
  CHECK_FALSE(is_over_after(kPoorStartTuning.clipped_grey, kPoorStartTuning.clipped_grey, 0));
  CHECK(is_over_after(kPoorStartTuning.clipped_grey, kPoorStartTuning.clipped_grey - 1, 0));
  CHECK_FALSE(is_over_after(kPoorStartTuning.clipped_grey - 1, kPoorStartTuning.clipped_grey, 0));
}

TEST_CASE("nothing is told of the light on a face that lies outside of the frame, on any side") {
  InArena<Estimator> estimator(baked_face().model, EstimatorLimits{});
  const std::vector<std::uint8_t> white(std::size_t{kWidth} * kHeight, 255);
  FrameView bright = film().view(0);
  bright.data = white.data();
  for (const Vec2 away : {Vec2{-1, 0}, Vec2{1, 0}, Vec2{0, -1}, Vec2{0, 1}}) {
    Pose pose = film().poses[0];
    pose.t = pose.t + pose.t.z * Vec3{away.x, away.y, 0};
    REQUIRE(estimator->start(film().camera, kWidth, kHeight, pose, film().parameters[0].data(), nullptr,
                             {}) == Status::ok);
    PoorStart start;
    start.begin(0, 100, bright, estimator.object);
    CHECK_FALSE(start.is_poor());
  }
}

}  // namespace poor_start_test
