#include "estimate/lens_transfer.hpp"

#include <doctest/doctest.h>

#include <limits>

namespace lens_transfer_test {

using namespace pliant;

namespace {

Lens barrel() {
  Camera camera = centred_camera(640, 480, 500);
  camera.k1 = -0.2f;
  camera.aspect = 1.1f;
  Lens lens;
  REQUIRE(Lens::make(camera, 640, 480, &lens) == Status::ok);
  return lens;
}

}  // namespace

TEST_CASE("undistorting and distorting observations restores them") {
  const Lens lens = barrel();
  Observation seen[2];
  seen[0].x = {80, 400};
  seen[0].information = {9, 2, 4};
  seen[1].x = {std::numeric_limits<float>::quiet_NaN(), 0};
  Observation o[2] = {seen[0], seen[1]};
  undistort(lens, Span<Observation>{o, 2});
  CHECK(length(o[0].x - seen[0].x) > 5);
  distort(lens, Span<Observation>{o, 2});
  CHECK(length(o[0].x - seen[0].x) < 2e-3f);
  CHECK(o[0].information.xx == doctest::Approx(9).epsilon(1e-3));
  CHECK(o[0].information.xy == doctest::Approx(2).epsilon(1e-3));
  CHECK(o[0].information.yy == doctest::Approx(4).epsilon(1e-3));
}

TEST_CASE("an information measures the same length before and after the lens") {
  const Lens lens = barrel();
  Observation o;
  o.x = lens.distort({100, 90});
  o.information = {9, 2, 4};
  const Sym2 there = o.information;
  const Vec2 seen_step = lens.distort({100.5f, 90.25f}) - o.x;
  undistort(lens, Span<Observation>{&o, 1});
  const Vec2 step{0.5f, 0.25f};
  const auto squared = [](Sym2 w, Vec2 r) {
    return w.xx * r.x * r.x + 2 * w.xy * r.x * r.y + w.yy * r.y * r.y;
  };
  o.residual = step;
  Observation back = o;
  distort(lens, Span<Observation>{&back, 1});
  CHECK(length(back.residual - seen_step) < 0.01f * length(seen_step));
  CHECK(length(back.residual - step) > 0.05f * length(step));
  CHECK(squared(o.information, step) == doctest::Approx(double(squared(there, seen_step))).epsilon(0.01));
}

TEST_CASE("a prediction's Jacobian and normal are those of the distorted image") {
  const Lens lens = barrel();
  Prediction p;
  p.x = {100, 90};
  p.jacobian = {30, 5, -8, 40};
  p.normal = {0.6f, 0.8f};
  p.covariance = {4, 0, 4};
  const Prediction before = p;
  distort(lens, &p);
  const float h = 1e-2f;
  const Vec2 du = (1 / h) * (lens.distort(before.x + h * Vec2{30, -8}) - lens.distort(before.x));
  CHECK(length(du - Vec2{p.jacobian.a, p.jacobian.c}) < 0.3f);
  // The edge runs perpendicular to its normal, before and after.
  const Vec2 along = lens.distort(before.x + Vec2{-0.8f, 0.6f}) - lens.distort(before.x - Vec2{-0.8f, 0.6f});
  CHECK(magnitude(dot(p.normal, along)) < 5e-3f);
  CHECK(length(p.normal) == doctest::Approx(1));
  CHECK(p.covariance.xx < before.covariance.xx);  // a barrel shrinks the corners
}

}  // namespace lens_transfer_test
