// Radial distortion of points, its inverse, and fit and estimator behind a lens.
#include "pliant/lens.hpp"

#include <doctest/doctest.h>

#include <initializer_list>
#include <limits>

#include "open_model.hpp"
#include "pliant/estimator.hpp"
#include "pliant/fit.hpp"
#include "random.hpp"

namespace lens_test {

using namespace pliant;

namespace {

constexpr int kWidth = 640, kHeight = 480;

Camera camera_with(float k1, float k2, float aspect = 1) {
  Camera camera{500, 325, 231};
  camera.k1 = k1;
  camera.k2 = k2;
  camera.aspect = aspect;
  return camera;
}

Lens lens_with(const Camera& camera) {
  Lens lens;
  REQUIRE(Lens::make(camera, kWidth, kHeight, &lens) == Status::ok);
  return lens;
}

/// Lenses from a fair webcam to the strongest that are let in.
const Camera kCameras[] = {camera_with(-0.25f, 0.06f),        camera_with(0.12f, -0.03f),
                           camera_with(-0.35f, 0.11f, 1.02f), camera_with(0.3f, 0.2f),
                           camera_with(0, 0, 0.93f),          camera_with(-0.1f, 0)};

}  // namespace

TEST_CASE("distortion is OpenCV's polynomial") {
  const Camera camera = camera_with(-0.25f, 0.06f, 1.1f);
  const Lens lens = lens_with(camera);
  const double x = 0.4, y = -0.3, s = x * x + y * y, grow = 1 - 0.25 * s + 0.06 * s * s;
  const Vec2 seen = lens.distort({static_cast<float>(500 * x + 325), static_cast<float>(500 * y + 231)});
  CHECK(double(seen.x) == doctest::Approx(500 * grow * x + 325).epsilon(1e-6));
  CHECK(double(seen.y) == doctest::Approx(1.1 * 500 * grow * y + 231).epsilon(1e-6));
}

TEST_CASE("distort and undistort are inverse to a thousandth of a pixel, inside the image and beyond") {
  for (const Camera& camera : kCameras) {
    CAPTURE(camera.k1);
    const Lens lens = lens_with(camera);
    float worst = 0;
    for (int y = -200; y < kHeight + 200; y += 7)
      for (int x = -200; x < kWidth + 200; x += 7) {
        const Vec2 seen{static_cast<float>(x), static_cast<float>(y)};
        worst = max(worst, length(lens.distort(lens.undistort(seen)) - seen));
        worst = max(worst, length(lens.undistort(lens.distort(seen)) - seen));
      }
    CHECK(worst < 1e-3f);
  }
}

TEST_CASE("no lens is no change, to the bit") {
  const Lens none, made = lens_with(camera_with(0, 0));
  CHECK(none.is_none());
  CHECK(made.is_none());
  for (const Lens& lens : {none, made}) {
    const Vec2 x{123.456f, 7.89f};
    CHECK(lens.distort(x).x == x.x);
    CHECK(lens.undistort(x).y == x.y);
  }
}

TEST_CASE("the derivative is that of the map") {
  Random random(3);
  for (const Camera& camera : kCameras) {
    const Lens lens = lens_with(camera);
    for (int k = 0; k < 100; ++k) {
      const Vec2 x{random.uniform(0, kWidth), random.uniform(0, kHeight)};
      Mat2 d;
      lens.distort(x, &d);
      const float h = 0.5f;
      const Vec2 along_x = lens.distort(x + Vec2{h, 0}) - lens.distort(x - Vec2{h, 0});
      const Vec2 along_y = lens.distort(x + Vec2{0, h}) - lens.distort(x - Vec2{0, h});
      CHECK(length(along_x - Vec2{d.a, d.c}) < 2e-3f);
      CHECK(length(along_y - Vec2{d.b, d.d}) < 2e-3f);
    }
    Mat2 d;
    lens.distort({camera.cx, camera.cy}, &d);
    CHECK(d.a == 1);
    CHECK(d.d == camera.aspect);
  }
}

TEST_CASE("a lens whose radius does not grow over the image, or NaN, is refused and changes nothing") {
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinite = std::numeric_limits<float>::infinity();
  Lens lens = lens_with(kCameras[0]);
  const Vec2 before = lens.distort({10, 20});
  for (const Camera& camera :
       {camera_with(-0.9f, 0), camera_with(0, -2), camera_with(-2, 1), camera_with(0.5f, -1),
        camera_with(nan, 0), camera_with(0, nan), camera_with(infinite, 0), camera_with(1e30f, -1e30f),
        camera_with(0, 0, 0.4f), camera_with(0, 0, nan), Camera{0, 1, 1}, Camera{nan, 1, 1},
        Camera{500, nan, 1}, Camera{1e-38f, 160, 120, 0.1f}, Camera{400, 3e38f, 120, 0.1f}})
    CHECK(Lens::make(camera, kWidth, kHeight, &lens) == Status::bad_argument);
  CHECK(Lens::make(kCameras[0], 0, kHeight, &lens) == Status::bad_argument);
  CHECK(Lens::make(kCameras[0], kWidth, kHeight, nullptr) == Status::bad_argument);
  CHECK(lens.distort({10, 20}).x == before.x);
  // A part of that picture is no problem: it does not reach so far out.
  CHECK(Lens::make(camera_with(-0.9f, 0), 400, 300, &lens) == Status::bad_argument);
  Camera middle = camera_with(-0.9f, 0);
  middle.cx = 100;
  middle.cy = 75;
  CHECK(Lens::make(middle, 200, 150, &lens) == Status::ok);
}

namespace {

/// The egg close to a wide-angle camera and off its axis, where a lens bends most.
struct Scene : OpenedEgg {
  Camera camera = camera_with(-0.3f, 0.09f, 1.03f);
  Lens lens = lens_with(camera);
  std::vector<float> truth;
  std::vector<Vec2> uv;

  Scene() : OpenedEgg(6) {
    truth.assign(model.parameters().count, 0);
    truth[0] = 0.8f;
    for (int i = 0; i < 49; ++i)
      uv.push_back({0.14f + 0.12f * static_cast<float>(i % 7), 0.14f + 0.12f * static_cast<float>(i / 7)});
  }
  static Pose pose(float turn) {
    return {normalised(exp_rotation({0.3f * turn, turn, 0.2f * turn})), {110, -70, 420}};
  }
  /// Where a point is seen through the lens.
  Vec2 seen(Vec2 at, float turn) {
    InArena<Cascade> cascade(model);
    Vec2 x;
    REQUIRE(
        Projector(view_of(pose(turn), camera), true).project(cascade->surface_point(at, truth.data()), &x));
    return lens.distort(x);
  }
  Camera without_lens() const { return {camera.f, camera.cx, camera.cy}; }
};

float turn_between(const Quat& a, const Quat& b) {
  return length(log_rotation(normalised(a * conjugate(b))));
}

/// Fits the egg to its image at a turn of 0.3 rad.
FitReport fit_with(Scene& scene, const Camera& camera, std::vector<Vec2>* residuals) {
  std::vector<Correspondence> points;
  for (const Landmark& l : scene.model.landmarks())
    points.push_back({l.uv(), scene.seen(l.uv(), 0.3f), 0.2f});
  FitLimits limits;
  limits.points = 100;
  InArena<Fitter> fitter(scene.model, limits);
  FitOptions options;
  options.width = kWidth;
  options.height = kHeight;
  options.camera = &camera;
  std::vector<float> q(scene.truth.size(), 0);
  residuals->resize(points.size());
  FitReport report;
  REQUIRE(fitter->fit({points.data(), points.size()}, options, q.data(), &report,
                      {nullptr, residuals->data()}) == Status::ok);
  return report;
}

}  // namespace

TEST_CASE("a fit that knows the lens finds the pose; one that does not is far worse") {
  Scene scene;
  std::vector<Vec2> residuals;
  const FitReport known = fit_with(scene, scene.camera, &residuals);
  CHECK(turn_between(known.view.q, scene.pose(0.3f).q) < 0.01f);
  CHECK(length(pose_of(known.view).t - scene.pose(0.3f).t) < 4);
  CHECK(camera_of(known.view).f == doctest::Approx(double(scene.camera.f)).epsilon(1e-4));
  CHECK(known.view.c.x == scene.camera.cx);
  for (const Vec2 r : residuals) CHECK(length(r) < 0.5f);
  const FitReport unknown = fit_with(scene, scene.without_lens(), &residuals);
  CHECK(turn_between(unknown.view.q, scene.pose(0.3f).q) >
        4 * turn_between(known.view.q, scene.pose(0.3f).q));
  CHECK(unknown.rms_px > 3 * known.rms_px);
  MESSAGE("turn error " << turn_between(known.view.q, scene.pose(0.3f).q) << " rad with the lens, "
                        << turn_between(unknown.view.q, scene.pose(0.3f).q) << " without");

  InArena<Fitter> fitter(scene.model, FitLimits{});
  const Correspondence points[4] = {
      {{0.2f, 0.2f}, {1, 1}}, {{0.8f, 0.2f}, {90, 1}}, {{0.2f, 0.8f}, {1, 90}}, {{0.8f, 0.8f}, {90, 90}}};
  const Camera folding = camera_with(-2, 0);
  FitOptions options;
  options.width = kWidth;
  options.height = kHeight;
  options.camera = &folding;
  FitReport report;
  CHECK(fitter->fit({points, 4}, options, scene.truth.data(), &report) == Status::bad_argument);
}

TEST_CASE("behind a lens an estimator predicts where points are seen, and follows them") {
  for (const bool is_known : {true, false}) {
    Scene scene;
    EstimatorLimits limits;
    limits.points = 60;
    limits.vertices = 300;
    InArena<Estimator> e(scene.model, limits);
    REQUIRE(e->start(is_known ? scene.camera : scene.without_lens(), kWidth, kHeight, scene.pose(0),
                     scene.truth.data(), nullptr, {}) == Status::ok);
    std::vector<std::uint16_t> ids(scene.uv.size());
    for (std::size_t i = 0; i < ids.size(); ++i) REQUIRE(e->add_point(scene.uv[i], &ids[i]) == Status::ok);
    InArena<Estimator> pinhole(scene.model, limits);
    REQUIRE(pinhole->start(scene.without_lens(), kWidth, kHeight, scene.pose(0), scene.truth.data(), nullptr,
                           {}) == Status::ok);
    for (std::size_t i = 0; is_known && i < ids.size(); ++i) {
      std::uint16_t id;
      REQUIRE(pinhole->add_point(scene.uv[i], &id) == Status::ok);
      const Prediction p = e->predict(ids[i]);
      CHECK(length(p.x - scene.seen(scene.uv[i], 0)) < 0.02f);
      // dx/d(u,v): the pinhole's, and then the lens's own derivative.
      const Prediction ideal = pinhole->predict(id);
      Mat2 d;
      scene.lens.distort(ideal.x, &d);
      const Mat2 expected = d * ideal.jacobian;
      CHECK(length(Vec2{p.jacobian.a - expected.a, p.jacobian.b - expected.b}) < 0.02f);
      CHECK(length(Vec2{p.jacobian.c - expected.c, p.jacobian.d - expected.d}) < 0.02f);
      CHECK(length(Vec2{p.jacobian.a, p.jacobian.c} - Vec2{ideal.jacobian.a, ideal.jacobian.c}) > 1);
      Vec2 x, uv;
      REQUIRE(e->project(scene.uv[i], &x));
      CHECK(length(x - p.x) < 0.02f);
      if (p.visible && e->surface_at(x, &uv) == 0) CHECK(length(uv - scene.uv[i]) < 2e-3f);
    }
    float turn = 0;
    for (int frame = 1; frame <= 25; ++frame) {
      turn = 0.012f * static_cast<float>(frame);
      e->begin(frame * std::int64_t{40'000'000});
      std::vector<Observation> observations;
      for (std::size_t i = 0; i < ids.size(); ++i) {
        Observation o;
        o.id = ids[i];
        o.x = scene.seen(scene.uv[i], turn);
        o.information = {100, 0, 25};
        observations.push_back(o);
      }
      const auto before = observations;
      e->solve({observations.data(), observations.size()});
      for (std::size_t i = 0; i < ids.size(); ++i) {
        CHECK(length(observations[i].x - before[i].x) < 2e-3f);
        CHECK(observations[i].information.xx == doctest::Approx(100).epsilon(1e-3));
        CHECK(observations[i].information.yy == doctest::Approx(25).epsilon(1e-3));
      }
      e->end();
    }
    const float off = turn_between(e->view().q, scene.pose(turn).q);
    MESSAGE("turn error " << off << " rad, lens known: " << is_known);
    if (is_known)
      CHECK(off < 0.004f);
    else
      CHECK(off > 0.008f);
  }
}

}  // namespace lens_test
