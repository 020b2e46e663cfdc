// Options of a fit beyond all measure.
#include <doctest/doctest.h>

#include <limits>

#include "open_model.hpp"
#include "pliant/fit.hpp"

namespace fit_options_test {

using namespace pliant;

namespace {

/// An egg's landmarks, and a fitter.
struct SeenEgg : OpenedEgg {
  InArena<Fitter> fitter{model, FitLimits{}};
  std::vector<Correspondence> points;

  SeenEgg() : OpenedEgg(6) {
    const View view =
        view_of({exp_rotation({0.1f, 0.2f, 0}), {20, -10, 700}}, centred_camera(640, 480, 900));
    for (const Landmark& l : model.landmarks()) {
      Vec2 x;
      const Vec3 p = fitter->cascade().surface_point(l.uv(), q.data());
      REQUIRE(Projector(view, true).project(p, &x));
      points.push_back({l.uv(), x, 0.5f});
    }
  }
  Span<const Correspondence> all() const { return {points.data(), points.size()}; }
};

template <class Change>
FitOptions with(const Change& change) {
  FitOptions options;
  options.width = 640;
  options.height = 480;
  options.focal_px = 900;
  change(options);
  return options;
}

}  // namespace

TEST_CASE("options of the dynamics that are no lengths or counts are refused") {
  SeenEgg egg;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const FitOptions wrong[] = {with([](auto& o) { o.euler.delta = 0; }),
                              with([=](auto& o) { o.euler.delta = nan; }),
                              with([](auto& o) { o.euler.steps = -1; }),
                              with([](auto& o) { o.euler.relative_decrease = -0.1f; }),
                              with([=](auto& o) { o.euler.relative_decrease = nan; })};
  for (FitOptions options : wrong) {
    options.method = FitMethod::euler;
    std::vector<float> q = egg.q;
    FitReport report;
    CHECK(egg.fitter->fit(egg.all(), options, q.data(), &report) == Status::bad_argument);
    CHECK(q == egg.q);
  }
}

TEST_CASE("extreme options give a status, or a finite result") {
  SeenEgg egg;
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
    if (egg.fitter->fit(egg.all(), extremes[k], q.data(), &report, {sd.data()}) != Status::ok)
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
