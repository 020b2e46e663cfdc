#include <doctest/doctest.h>

#include <limits>

#include "open_model.hpp"
#include "pliant/fit.hpp"

namespace fit_start_test {

using namespace pliant;

namespace {

/// A sheet of 100 x 150 mm beside the origin, with so many landmarks of a face in its middle: a fifth of its sides away from it.
OpenModel sheet_with_landmarks(int landmarks) {
  ModelBuilder b;
  b.record(Operation::constant, {}, {}, b.field(3, 2, 2, [](float u, float v) {
    return Vec3{30 + 100 * u, 40 - 150 * v, 0};
  }));
  b.grid_mesh(2);
  b.landmark("p", 0.5f, 0.5f);
  const char* const names[] = {"ibug00", "ibug16", "ibug08", "ibug27"};
  for (int k = 0; k < landmarks; ++k) b.landmark(names[k], k % 2 == 0 ? 0.3f : 0.7f, k < 2 ? 0.3f : 0.7f);
  return OpenModel(b);
}

}  // namespace

TEST_CASE(
    "a box is of the landmarks of a face, from four on, or else of the mesh: its middle, and the mean of the "
    "scales") {
  for (const int landmarks : {0, 3, 4}) {
    CAPTURE(landmarks);
    const OpenModel sheet = sheet_with_landmarks(landmarks);
    InArena<Cascade> cascade(sheet.model);
    View view;
    const Vec2 corner{100, 80}, size{160, 200};
    REQUIRE(view_from_box(cascade.object, nullptr, corner, size, centred_camera(640, 480, 900), &view) ==
            Status::ok);
    const float margin = landmarks < 4 ? 0.0f : 0.3f;
    Vec2 low, high;
    const Projector projector(view, true);
    REQUIRE(projector.project(cascade->surface_point({margin, margin}, nullptr), &low));
    REQUIRE(projector.project(cascade->surface_point({1 - margin, 1 - margin}, nullptr), &high));
    CHECK(length(0.5f * (low + high) - (corner + 0.5f * size)) < 0.01f);
    const Vec2 extent = (1 - 2 * margin) * Vec2{100, 150};  // mm
    const float px_per_mm = 0.5f * (size.x / extent.x + size.y / extent.y);
    CHECK(length(high - low - px_per_mm * extent) < 0.02f);
  }
}

TEST_CASE("a box starts a frontal view that fills it") {
  const OpenedEgg egg(6);
  InArena<Cascade> cascade(egg.model);
  View view;
  const Camera camera = centred_camera(640, 480, 900);
  REQUIRE(view_from_box(cascade.object, egg.q.data(), {100, 80}, {150, 200}, camera, &view) == Status::ok);
  Vec2 low{1e9f, 1e9f}, high{-1e9f, -1e9f};
  for (Vec2 uv : egg.model.base_uv()) {
    Vec2 x;
    REQUIRE(Projector(view, true).project(cascade->surface_point(uv, egg.q.data()), &x));
    low = min(low, x);
    high = max(high, x);
  }
  CHECK(low.x == doctest::Approx(100).epsilon(0.1));
  CHECK(high.y == doctest::Approx(280).epsilon(0.05));
}

TEST_CASE(
    "the view of a box has the camera's focal length, also where the box is nearer or farther than any "
    "view") {
  const OpenedEgg egg(6);
  InArena<Cascade> cascade(egg.model);
  View view;
  for (const float focal : {20.0f, 900.0f, 1e6f}) {
    const Camera camera = centred_camera(640, 480, focal);
    REQUIRE(view_from_box(cascade.object, egg.q.data(), {100, 80}, {150, 200}, camera, &view) == Status::ok);
    CHECK(camera_of(view).f == doctest::Approx(static_cast<double>(focal)).epsilon(1e-3));
    CHECK(is_possible(pose_of(view), camera_of(view)));
  }
}

TEST_CASE("no view puts a model without width or without height into a box") {
  for (const Vec2 extent : {Vec2{0, 100}, Vec2{100, 0}, Vec2{100, 100}}) {
    ModelBuilder b;
    b.record(Operation::constant, {}, {}, b.field(3, 2, 2, [=](float u, float v) {
      return Vec3{extent.x * u, -extent.y * v, 20 * u * v};
    }));
    b.grid_mesh(2);
    b.landmark("p", 0.5f, 0.5f);
    const OpenModel built(b);
    InArena<Cascade> cascade(built.model);
    View view;
    const Status status =
        view_from_box(cascade.object, nullptr, {100, 80}, {150, 200}, centred_camera(640, 480, 900), &view);
    CHECK(status == (extent.x > 0 && extent.y > 0 ? Status::ok : Status::bad_argument));
  }
}

TEST_CASE("points beyond a million px are refused: their squares would be infinite") {
  const OpenedEgg egg(6);
  InArena<Fitter> fitter(egg.model, FitLimits{});
  std::vector<Correspondence> points(8);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto step = static_cast<float>(k);
    points[k].uv = {0.2f + 0.05f * step, k % 2 == 0 ? 0.3f : 0.6f};
    points[k].x = {100 + 20 * step, k % 2 == 0 ? 100.0f : 180.0f};
  }
  FitOptions options;
  options.width = 320;
  options.height = 240;
  for (const float far : {1e30f, -1.1e6f}) {
    points[3].x.y = far;
    FitReport report;
    std::vector<float> q = egg.q;
    CHECK(fitter->fit({points.data(), points.size()}, options, q.data(), &report) == Status::bad_argument);
  }
}

TEST_CASE("a box without area, a camera that is not finite, and a view beyond all bounds start nothing") {
  const OpenedEgg egg(6);
  InArena<Cascade> cascade(egg.model);
  const Camera camera = centred_camera(640, 480, 900);
  View view;
  view.s = 7;
  const auto status = [&](Vec2 size, const Camera& by) {
    return view_from_box(cascade.object, egg.q.data(), {0, 0}, size, by, &view);
  };
  CHECK(status({0, 10}, camera) == Status::bad_argument);
  CHECK(status({10, 0}, camera) == Status::bad_argument);
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    CHECK(status({bad, 10}, camera) == Status::bad_argument);
    for (float Camera::*const number : {&Camera::f, &Camera::cx, &Camera::cy}) {
      Camera other = camera;
      other.*number = bad;
      CHECK(status({10, 10}, other) == Status::bad_argument);
    }
  }
  CHECK(status({10, 10}, {1e-38f, 320, 240}) == Status::bad_argument);
  CHECK(status({10, 10}, {900, 3e38f, 240}) == Status::bad_argument);
  CHECK(view.s == 7);
}

}  // namespace fit_start_test
