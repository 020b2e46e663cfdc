// Fits to points of a sheet that bends: tilted one way and bent one way it looks much as the other way round.
#include <doctest/doctest.h>

#include <cmath>

#include "model_builder.hpp"
#include "pliant/fit.hpp"
#include "random_model.hpp"

namespace other_solutions_test {

using namespace pliant;

namespace {

/// A sheet of 200 x 150 mm that bends along both sides and twists.
ModelBuilder sheet() {
  ModelBuilder b;
  b.record(Operation::constant, {}, {}, b.field(3, 9, 9, [](float u, float v) {
    return Vec3{200 * (u - 0.5f), -150 * (v - 0.5f), 0};
  }));
  const auto bends = [&](const char* name, const ModelBuilder::Function& along) {
    const auto parameter = b.parameter(name, Group::expression, -3, 3, 1);
    b.record(Operation::add_vector, {b.last()}, {parameter}, b.field(3, 9, 9, along));
  };
  bends("across", [](float u, float) { return Vec3{0, 0, 60 * (u - 0.5f) * (u - 0.5f)}; });
  bends("along", [](float, float v) { return Vec3{0, 0, 60 * (v - 0.5f) * (v - 0.5f)}; });
  bends("twist", [](float u, float v) { return Vec3{0, 0, 60 * (u - 0.5f) * (v - 0.5f)}; });
  b.grid_mesh(9);
  b.landmark("middle", 0.5f, 0.5f);
  return b;
}

}  // namespace

TEST_CASE("a bent sheet is fitted with the right tilt, from few points and from many") {
  const OpenModel m(sheet());
  InArena<Cascade> cascade(m.model);
  Random random(11);
  FitOptions options;
  options.width = 640;
  options.height = 480;
  options.focal_px = 850;
  for (const int side : {3, 6}) {
    InArena<Fitter> fitter(m.model, FitLimits{});
    int wrong = 0;
    for (int trial = 0; trial < 40; ++trial) {
      const std::vector<float> truth{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
      const Quat q = exp_rotation(
          {random.uniform(-0.6f, 0.6f), random.uniform(-0.6f, 0.6f), random.uniform(-0.6f, 0.6f)});
      const View view = view_of({q, {0, 0, 700}}, centred_camera(640, 480, 850));
      std::vector<Correspondence> points;
      for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j) {
          Correspondence c;
          c.uv = {static_cast<float>(i) / static_cast<float>(side - 1),
                  static_cast<float>(j) / static_cast<float>(side - 1)};
          c.sd_px = 3;  // as a start from points takes it: of a hundredth of their spread
          REQUIRE(Projector(view, true).project(cascade->surface_point(c.uv, truth.data()), &c.x));
          points.push_back(c);
        }
      std::vector<float> fitted(3, 0.0f);
      FitReport report;
      REQUIRE(fitter->fit({points.data(), points.size()}, options, fitted.data(), &report) == Status::ok);
      wrong += length(log_rotation(report.view.q * conjugate(q))) > 0.17f;
    }
    CAPTURE(side);
    CHECK(wrong == 0);
  }
}

TEST_CASE("a start that is given is kept: no other solution is looked for") {
  const OpenModel m(sheet());
  InArena<Cascade> cascade(m.model);
  InArena<Fitter> fitter(m.model, FitLimits{});
  const Camera camera = centred_camera(640, 480, 850);
  const std::vector<float> truth{1, 0, 0};
  const View view = view_of({exp_rotation({0, 0.5f, 0}), {0, 0, 2000}}, camera),
             other = view_of({exp_rotation({0, -0.5f, 0}), {0, 0, 2000}}, camera);
  std::vector<Correspondence> points;
  for (const Vec2 uv : {Vec2{0, 0}, Vec2{1, 0}, Vec2{0, 1}, Vec2{1, 1}, Vec2{0.5f, 0.5f}}) {
    Correspondence c;
    c.uv = uv;
    c.sd_px = 3;
    REQUIRE(Projector(view, true).project(cascade->surface_point(uv, truth.data()), &c.x));
    points.push_back(c);
  }
  FitOptions options;
  options.width = 640;
  options.height = 480;
  options.focal_px = 850;
  options.start = &other;
  std::vector<float> fitted(3, 0.0f);
  FitReport report;
  REQUIRE(fitter->fit({points.data(), points.size()}, options, fitted.data(), &report) == Status::ok);
  CHECK(log_rotation(report.view.q).y < 0);
}

}  // namespace other_solutions_test
