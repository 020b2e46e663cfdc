// Options of a fit beyond all measure.
#include <doctest/doctest.h>

#include <limits>

#include "opened_egg.hpp"
#include "pliant/fit.hpp"

namespace fit_options_test {

using namespace pliant;

TEST_CASE("extreme options give a status, or a finite result") {
  const OpenedEgg egg(6);
  const View view = view_of({exp_rotation({0.1f, 0.2f, 0}), {20, -10, 700}}, centred_camera(640, 480, 900));
  InArena<Fitter> fitter(egg.model, FitLimits{});
  std::vector<Correspondence> points;
  for (const Landmark& l : egg.model.landmarks()) {
    Vec2 x;
    const Vec3 p = fitter->cascade().surface_point({l.u, l.v}, egg.q.data());
    REQUIRE(Projector(view, true).project(p, &x));
    points.push_back({{l.u, l.v}, x, 0.5f});
  }
  const auto with = [](auto change) {
    FitOptions options;
    options.width = 640;
    options.height = 480;
    options.focal_px = 900;
    change(options);
    return options;
  };
  const float infinite = std::numeric_limits<float>::infinity();
  std::vector<FitOptions> extremes = {with([](auto&) {}), with([](auto& o) { o.iterations = -5; }),
                                      with([](auto& o) { o.iterations = 3000; }),
                                      with([](auto& o) { o.width = o.height = 2'000'000'000; })};
  for (const float x : {1e-45f, 1e-30f, 1e10f, 1e20f, 3e38f, infinite}) {
    extremes.push_back(with([=](auto& o) { o.stiffness = x; }));
    extremes.push_back(with([=](auto& o) { o.misfit_mm = x; }));
    extremes.push_back(with([=](auto& o) { o.focal_px = x; }));
    extremes.push_back(with([=](auto& o) {
      o.method = FitMethod::euler;
      o.euler.steps = 20;
      o.euler.delta = x;
    }));
  }
  int fitted = 0;
  for (std::size_t k = 0; k < extremes.size(); ++k) {
    CAPTURE(k);
    std::vector<float> q = egg.q, sd(q.size());
    FitReport report;
    if (fitter->fit({points.data(), points.size()}, extremes[k], q.data(), &report, {sd.data()}) !=
        Status::ok)
      continue;
    ++fitted;
    CHECK(is_finite(report.rms_px));
    CHECK(is_finite(pose_of(report.view)));
    for (std::size_t i = 0; i < q.size(); ++i) CHECK((is_finite(q[i]) && is_finite(sd[i])));
    for (const float value : report.pose_sd) CHECK(is_finite(value));
  }
  CHECK(fitted > 5);
}

}  // namespace fit_options_test
