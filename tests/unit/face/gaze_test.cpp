// The direction of the gaze from where pupils are seen.
#include "face/gaze.hpp"

#include <doctest/doctest.h>

#include <initializer_list>
#include <limits>

namespace gaze_test {

using namespace pliant;

namespace {

constexpr Vec3 kCorners{31, -1, 2.5f};  // of the left eye

/// A head that is turned, and off the middle of the picture.
View view_at(Vec3 turn, Vec3 place) {
  return view_of({exp_rotation(turn), place}, centred_camera(640, 480, 700));
}

/// Where the pupil of an eye is seen that looks along `gaze`.
SeenEye eye_looking(Vec3 gaze, bool is_left, const View& view) {
  SeenEye eye;
  const float side = is_left ? 1.0f : -1.0f;
  eye.corners = {side * kCorners.x, kCorners.y, kCorners.z};
  const Vec3 ball =
      eye.corners + Vec3{side * kGazeTuning.ball_mm.x, kGazeTuning.ball_mm.y, kGazeTuning.ball_mm.z};
  REQUIRE(Projector(view, true).project(ball + kGazeTuning.iris_mm * normalised(gaze), &eye.pupil));
  eye.opening_mm = 9;
  return eye;
}

const Vec3 kTurns[] = {{}, {0.2f, -0.5f, 0.1f}, {-0.3f, 0.4f, -0.6f}};
const Vec3 kPlaces[] = {{0, 0, 500}, {-150, 100, 450}, {200, -120, 5000}};

}  // namespace

TEST_CASE("the gaze is found that put the pupils where they are, wherever the head is") {
  for (const Vec3 turn : kTurns)
    for (const Vec3 place : kPlaces)
      for (const Vec3 gaze : {Vec3{0, 0, 1}, Vec3{0.3f, 0.1f, 1}, Vec3{-0.4f, -0.3f, 1}}) {
        const View view = view_at(turn, place);
        const SeenEye eyes[] = {eye_looking(gaze, false, view), eye_looking(gaze, true, view)};
        CHECK(length(find_gaze({eyes, 2}, view) - normalised(gaze)) < 0.01f);
        CHECK(length(find_gaze({eyes, 1}, view) - normalised(gaze)) < 0.01f);
      }
}

TEST_CASE("eyes that differ give the middle; an eye that is shut does not count") {
  const View view = view_at({}, {0, 0, 500});
  SeenEye eyes[] = {eye_looking({0.2f, 0, 1}, false, view), eye_looking({-0.2f, 0, 1}, true, view)};
  CHECK(length(find_gaze({eyes, 2}, view) - Vec3{0, 0, 1}) < 0.01f);
  eyes[1].opening_mm = 2;
  CHECK(length(find_gaze({eyes, 2}, view) - normalised(Vec3{0.2f, 0, 1})) < 0.01f);
  eyes[0].opening_mm = 2;
  CHECK(length(find_gaze({eyes, 2}, view)) == 0);
}

TEST_CASE(
    "an upper lid that is high or low over the pupil raises or lowers the gaze, in the head's axes and not "
    "by much") {
  for (const Vec3 turn : kTurns) {
    const View view = view_at(turn, {0, 0, 500});
    SeenEye eye = eye_looking({0, 0, 1}, true, view);
    const auto gaze_with_lid = [&](float higher_mm) {
      eye.lid_mm = kGazeTuning.lid_mm + higher_mm;
      return find_gaze({&eye, 1}, view);
    };
    const float rise = kGazeTuning.lid_weight * 1 / kGazeTuning.iris_mm;
    CHECK(length(gaze_with_lid(0) - Vec3{0, 0, 1}) < 0.01f);
    CHECK(length(gaze_with_lid(1) - Vec3{0, rise, 1}) < 0.02f);
    CHECK(length(gaze_with_lid(-1) - Vec3{0, -rise, 1}) < 0.02f);
    CHECK(length(gaze_with_lid(100) - gaze_with_lid(kGazeTuning.most_lid_mm)) == 0);
    CHECK(length(gaze_with_lid(-100) - gaze_with_lid(-kGazeTuning.most_lid_mm)) == 0);
    CHECK(length(gaze_with_lid(std::numeric_limits<float>::quiet_NaN())) <= 1.0001f);
  }
}

TEST_CASE("no gaze from heads that are turned away, pupils off the eye, no eyes, or what is no number") {
  const View turned = view_at({0, 1, 0}, {0, 0, 500}), view = view_at({}, {0, 0, 500});
  SeenEye eye = eye_looking({0, 0, 1}, true, turned);
  CHECK(length(find_gaze({&eye, 1}, turned)) == 0);
  eye = eye_looking({0, 0, 1}, true, view);
  eye.pupil = eye.pupil + Vec2{40, 0};
  CHECK(length(find_gaze({&eye, 1}, view)) == 0);
  CHECK(length(find_gaze({}, view)) == 0);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  eye.pupil = {nan, 0};
  CHECK(length(find_gaze({&eye, 1}, view)) == 0);
  eye.opening_mm = nan;
  CHECK(length(find_gaze({&eye, 1}, view)) == 0);
  View broken = view;
  broken.q = {nan, nan, nan, nan};
  CHECK(length(find_gaze({&eye, 1}, broken)) == 0);
}

TEST_CASE("the gaze follows in a few frames, begins at once, and ends at once") {
  const Vec3 ahead{0, 0, 1}, aside = normalised(Vec3{0.5f, 0, 1});
  constexpr float kFrame = kGazeTuning.half_way_s;
  Vec3 gaze = smoothed_gaze({}, ahead, kFrame);
  CHECK(length(gaze - ahead) == 0);
  gaze = smoothed_gaze(gaze, aside, kFrame);
  CHECK(length(gaze - normalised(ahead + aside)) < 1e-6f);
  for (int k = 0; k < 4; ++k) gaze = smoothed_gaze(gaze, aside, kFrame);
  CHECK(length(gaze - aside) < 0.03f);
  CHECK(length(gaze) == doctest::Approx(1));
  CHECK(length(smoothed_gaze(gaze, {}, kFrame)) == 0);
}

TEST_CASE("the gaze follows in about the same time at any frame rate") {
  const Vec3 ahead{0, 0, 1}, aside = normalised(Vec3{0.2f, 0, 1});
  for (const int rate : {10, 15, 25, 30, 50, 60, 100}) {
    CAPTURE(rate);
    Vec3 gaze = ahead;
    for (int k = 0; k < rate / 5; ++k)
      gaze = smoothed_gaze(gaze, aside, 1.0f / static_cast<float>(rate));
    const float rest = length(gaze - aside) / length(ahead - aside);  // after 0.2 s
    CHECK(rest > 0.01f);
    CHECK(rest < 0.09f);
  }
}

}  // namespace gaze_test
