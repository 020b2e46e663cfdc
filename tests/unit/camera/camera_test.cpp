#include "pliant/camera.hpp"

#include <doctest/doctest.h>

#include <initializer_list>
#include <limits>

#include "random.hpp"

namespace camera_test {

using namespace pliant;

namespace {
View random_view(Random& random) {
  View view;
  view.q =
      exp_rotation({random.uniform(-0.8f, 0.8f), random.uniform(-0.8f, 0.8f), random.uniform(-0.8f, 0.8f)});
  view.s = random.uniform(0.5f, 4);
  view.tau = {random.uniform(-50, 50), random.uniform(-50, 50)};
  view.rho = random.uniform(5e-4f, 3e-3f);
  view.c = {159.5f, 119.5f};
  return view;
}
}  // namespace

TEST_CASE(
    "the direction of the camera: unit, ahead of a frontal face, and the same when the picture is turned") {
  const Vec3 ahead = camera_direction(View{});
  CHECK(ahead.x == 0);
  CHECK(ahead.y == 0);
  CHECK(ahead.z == 1);
  Random random(5);
  for (int k = 0; k < 100; ++k) {
    const View view = random_view(random);
    const Vec3 towards = camera_direction(view);
    CHECK(dot(towards, towards) == doctest::Approx(1).epsilon(1e-5));
    // A point moved along it comes nearer and stays where it is seen, but for perspective.
    const Vec3 moved = Projector(view, true).rotated(towards);
    CHECK(moved.x == doctest::Approx(0).epsilon(1e-5));
    CHECK(moved.y == doctest::Approx(0).epsilon(1e-5));
    CHECK(moved.z == doctest::Approx(-1).epsilon(1e-5));
    View turned = view;
    turned.q = exp_rotation({0, 0, random.uniform(-3, 3)}) * view.q;
    const Vec3 same = camera_direction(turned) - towards;
    CHECK(dot(same, same) < 1e-10f);
  }
}

TEST_CASE("the pinhole projection with the documented axes") {
  // A frontal face 1000 mm away: the subject's left is to the right of the picture, up is up.
  const Camera camera = centred_camera(320, 240, 500);
  const View view = view_of({{1, 0, 0, 0}, {0, 0, 1000}}, camera);
  const Projector projector(view, true);
  Vec2 x;
  REQUIRE(projector.project({0, 0, 0}, &x));
  CHECK(x.x == doctest::Approx(159.5));
  CHECK(x.y == doctest::Approx(119.5));
  REQUIRE(projector.project({40, 20, 100}, &x));  // 100 mm towards the camera
  CHECK(x.x == doctest::Approx(159.5 + 500 * 40.0 / 900).epsilon(1e-5));
  CHECK(x.y == doctest::Approx(119.5 - 500 * 20.0 / 900).epsilon(1e-5));
}

TEST_CASE("the signs of turns: yaw to the subject's right, pitch down, roll clockwise as one sees it") {
  // fixtures/pictures/axes.svg shows these: a nose 100 mm in front of the origin, the subject's left ear, a chin.
  const Camera camera = centred_camera(320, 240, 500);
  const auto seen = [&](Vec3 turn, Vec3 p) {
    Vec2 x;
    REQUIRE(Projector(view_of({exp_rotation(turn), {0, 0, 1000}}, camera), true).project(p, &x));
    return x - Vec2{camera.cx, camera.cy};
  };
  const Vec3 nose{0, 0, 100}, left_ear{80, 0, 0}, chin{0, -100, 0};
  const Vec3 pitch{0.3f, 0, 0}, yaw{0, 0.3f, 0}, roll{0, 0, 0.3f};
  CHECK(seen({}, left_ear).x > 30);  // the subject's left is on the right of the picture
  CHECK(seen({}, chin).y > 40);      // y of the picture runs down
  CHECK(seen(yaw, nose).x < -10);
  CHECK(magnitude(seen(yaw, nose).y) < 1e-3f);
  CHECK(seen(pitch, nose).y > 10);
  CHECK(magnitude(seen(pitch, nose).x) < 1e-3f);
  CHECK(seen(roll, left_ear).y > 10);  // the right of the picture goes down
  CHECK(seen(roll, chin).x < -10);
  CHECK(length(seen(roll, nose)) < 1e-3f);
  // R = Rz(roll) Ry(yaw) Rx(pitch): what is turned first stands on the right.
  const Quat all = exp_rotation(roll) * exp_rotation(yaw) * exp_rotation(pitch);
  const Mat3 r = rotation_matrix(all);
  const Vec3 forward = r * Vec3{0, 0, -1};
  CHECK(forward.x < 0);
  CHECK(forward.y > 0);
}

TEST_CASE("pose and camera survive the solver's form") {
  const Pose pose{exp_rotation({0.1f, -0.4f, 0.2f}), {12, -30, 640}};
  const Camera camera{701, 150, 130};
  const View view = view_of(pose, camera);
  const Pose back = pose_of(view);
  CHECK(back.t.z == doctest::Approx(640).epsilon(1e-5));
  CHECK(back.t.x == doctest::Approx(12));
  CHECK(camera_of(view).f == doctest::Approx(701).epsilon(1e-5));
}

TEST_CASE("derivatives of the projection agree with central differences") {
  Random random(4);
  for (int trial = 0; trial < 200; ++trial) {
    const View view = random_view(random);
    const Vec3 p{random.uniform(-80, 80), random.uniform(-80, 80), random.uniform(-80, 80)};
    for (int unknowns : {kPoseUnknowns, kPoseUnknownsWithFocal}) {
      Vec2 x;
      Projector::Derivatives d;
      REQUIRE(Projector(view, unknowns == kPoseUnknowns).project(p, &x, &d));
      for (int k = 0; k < unknowns; ++k) {
        const float h = k == kShiftX || k == kShiftY ? 0.5f : 5e-3f;
        float step[kPoseUnknownsWithFocal] = {};
        Vec2 ahead, behind;
        step[k] = h;
        REQUIRE(Projector(moved(view, step, unknowns), true).project(p, &ahead));
        step[k] = -h;
        REQUIRE(Projector(moved(view, step, unknowns), true).project(p, &behind));
        const Vec2 difference = (0.5f / h) * (ahead - behind);
        CHECK(length(difference - d.pose[k]) < 2e-3f * length(d.pose[k]) + 0.05f);
      }
      for (int c = 0; c < 3; ++c) {
        const Vec3 e{c == 0 ? 0.5f : 0, c == 1 ? 0.5f : 0, c == 2 ? 0.5f : 0};
        Vec2 ahead, behind;
        REQUIRE(Projector(view, true).project(p + e, &ahead));
        REQUIRE(Projector(view, true).project(p - e, &behind));
        CHECK(length((ahead - behind) - d.along(2 * e)) < 2e-3f);
      }
    }
  }
}

TEST_CASE("with a known focal length a change of scale keeps it, up to the bounds of the distance") {
  Random random(6);
  View view = random_view(random);
  const float f = camera_of(view).f;
  float step[kPoseUnknowns] = {};
  step[kLogScale] = 0.3f;
  CHECK(camera_of(moved(view, step, kPoseUnknowns)).f == doctest::Approx(double(f)).epsilon(1e-5));
  CHECK(moved(view, step, kPoseUnknowns).s == doctest::Approx(double(view.s * 1.3498588f)).epsilon(1e-5));
  for (int i = 0; i < 30; ++i) view = moved(view, step, kPoseUnknowns);
  CHECK(view.rho == kMaxRho);
  CHECK(camera_of(view).f == doctest::Approx(double(f)).epsilon(1e-3));
}

TEST_CASE("what is not finite is no possible pose or camera, whichever number it is") {
  const Camera camera = centred_camera(640, 480, 500);
  CHECK(is_possible(Pose{}, camera));
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    for (float Camera::*const number : {&Camera::f, &Camera::cx, &Camera::cy}) {
      Camera other = camera;
      other.*number = bad;
      CHECK_FALSE(is_possible(Pose{}, other));
    }
    for (float Vec3::*const number : {&Vec3::x, &Vec3::y, &Vec3::z}) {
      Pose pose;
      pose.t.*number = bad;
      CHECK_FALSE(is_possible(pose, camera));
    }
    for (float Quat::*const number : {&Quat::w, &Quat::x, &Quat::y, &Quat::z}) {
      Pose pose;
      pose.q.*number = bad;
      CHECK_FALSE(is_possible(pose, camera));
    }
  }
}

TEST_CASE("a point at or behind the camera is refused") {
  const Projector projector(view_of({{1, 0, 0, 0}, {0, 0, 100}}, {500, 0, 0}), true);
  Vec2 x{7, 7};
  CHECK_FALSE(projector.project({0, 0, 90}, &x));
  CHECK_FALSE(projector.project({0, 0, 150}, &x));
  CHECK(x.x == 7);
}

TEST_CASE(
    "a pose is possible between 50 mm and 100 m, with about a unit quaternion, and a camera with a focal "
    "length") {
  const Camera camera = centred_camera(320, 240, 400);
  const auto with = [&](Quat q, Vec3 t) { return is_possible({q, t}, camera); };
  const Quat ahead;
  CHECK(with(ahead, {0, 0, 500}));
  CHECK(with(ahead, {0, 0, 50}));
  CHECK(with(ahead, {0, 0, 1e5f}));
  CHECK(with({0.8f, 0, 0, 0}, {0, 0, 500}));
  CHECK(with({0, 1.3f, 0, 0}, {0, 0, 500}));
  CHECK(with(ahead, {1e7f, -1e7f, 500}));
  for (const Vec3 t :
       {Vec3{0, 0, 49}, Vec3{0, 0, 1.01e5f}, Vec3{0, 0, -500}, Vec3{1.1e7f, 0, 500}, Vec3{0, -1.1e7f, 500}})
    CHECK_FALSE(with(ahead, t));
  for (const Quat q : {Quat{0.69f, 0, 0, 0}, Quat{0, 0, 1.42f, 0}, Quat{0, 0, 0, 0}})
    CHECK_FALSE(with(q, {0, 0, 500}));
  Camera other = camera;
  for (const float f : {0.0f, 9e-4f, -400.0f, 1.1e7f}) {
    other.f = f;
    CHECK_FALSE(is_possible({ahead, {0, 0, 500}}, other));
  }
}

}  // namespace camera_test
