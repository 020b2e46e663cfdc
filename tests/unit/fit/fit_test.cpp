#include "pliant/fit.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>

#include "fit_scene.hpp"
#include "pliant/fold_over.hpp"
#include "random.hpp"

namespace fit_test {

using namespace pliant;
using Scene = FitScene;

namespace {

FitLimits limits() {
  FitLimits l;
  l.points = 100;
  return l;
}

}  // namespace

TEST_CASE("exact correspondences give back pose and parameters, with no start") {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const Scene scene(seed);
    InArena<Fitter> fitter(scene.model, limits());
    std::vector<float> q(scene.truth.size(), 0), sd(q.size());
    FitReport report;
    REQUIRE(fitter->fit(scene.all(), scene.options(900), q.data(), &report, {sd.data()}) == Status::ok);
    CHECK(report.rms_px < 0.1f);
    CHECK(report.used == scene.points.size());
    CHECK(scene.turn_error(report.view) < 0.01f);
    for (std::size_t k = 0; k < q.size(); ++k)
      CHECK(magnitude(q[k] - scene.truth[k]) < 5 * sd[k] + 0.02f * scene.model.parameters()[k].sd);
  }
}

TEST_CASE("one iteration in all is one a stage") {
  const Scene scene(1);
  InArena<Fitter> fitter(scene.model, limits());
  std::vector<float> q(scene.truth.size(), 0);
  FitReport few;
  FitOptions options = scene.options(900);
  options.iterations = 1;
  REQUIRE(fitter->fit(scene.all(), options, q.data(), &few) == Status::ok);
  CHECK(few.iterations == 3);
  CHECK(few.rms_px < 20);
}

TEST_CASE("errors of a noisy fit are as large as the standard deviations say, and those of a misfit") {
  float misfit_mm = 0;
  SUBCASE("noise") {}
  SUBCASE("noise and misfit") {
    misfit_mm = 3;
  }
  double sum = 0, count = 0, pose_sum = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Scene scene(seed, 0.5f, 0.4f);
    Random random(200 + seed);
    for (auto& p : scene.points)
      p.x = p.x + misfit_mm * scene.view.s * Vec2{random.normal(), random.normal()};
    InArena<Fitter> fitter(scene.model, limits());
    std::vector<float> q(scene.truth.size(), 0), sd(q.size());
    FitReport report;
    FitOptions options = scene.options(900);
    options.misfit_mm = misfit_mm;
    REQUIRE(fitter->fit(scene.all(), options, q.data(), &report, {sd.data()}) == Status::ok);
    for (std::size_t k = 0; k < 6; ++k) {
      const double z = double((q[k] - scene.truth[k]) / sd[k]);
      sum += z * z;
      ++count;
    }
    const Vec3 turn = log_rotation(scene.view.q * conjugate(report.view.q));
    const float off[3] = {turn.x, turn.y, turn.z};
    for (int k = 0; k < 3; ++k) {
      CHECK(report.pose_sd[k] > 0);
      pose_sum += double(off[k] * off[k] / (report.pose_sd[k] * report.pose_sd[k])) / 90;
    }
    CHECK(report.pose_sd[kLogRho] == 0);
  }
  CHECK(pose_sum > 0.5);
  CHECK(pose_sum < (misfit_mm > 0 ? 3 : 1.8));
  CHECK(sum / count > 0.4);
  CHECK(sum / count <
        (misfit_mm > 0 ? 3 : 2));  // points weigh by their own deviations: the fit is not the best one then
}

TEST_CASE("deviations of the points alone are those of a model without an error of its own") {
  const Scene scene(5, 0, 0.4f);
  InArena<Fitter> fitter(scene.model, limits());
  const std::size_t n = scene.truth.size();
  std::vector<float> exact(n), with_misfit(n), of_points(n);
  const auto fit = [&](float misfit_mm, const FitDetails& details) {
    std::vector<float> q(n, 0);
    FitReport report;
    FitOptions options = scene.options(900);
    options.misfit_mm = misfit_mm;
    REQUIRE(fitter->fit(scene.all(), options, q.data(), &report, details) == Status::ok);
  };
  fit(0, {exact.data()});
  fit(3, {with_misfit.data(), nullptr, nullptr, of_points.data()});
  for (std::size_t k = 0; k < n; ++k) {
    CHECK(of_points[k] == doctest::Approx(double(exact[k])).epsilon(0.05));
    CHECK(with_misfit[k] > of_points[k]);
  }
}

TEST_CASE("thirty per cent of gross outliers are given no weight and hardly move the pose") {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Scene scene(seed, 0.5f, 0.4f);
    Random random(100 + seed);
    std::vector<bool> bad(scene.points.size(), false);
    for (std::size_t i = 0; i < scene.points.size(); ++i)
      if (random.below(10) < 3) {
        bad[i] = true;
        scene.points[i].x = {random.uniform(200, 440), random.uniform(140, 340)};
      }
    InArena<Fitter> fitter(scene.model, limits());
    std::vector<float> q(scene.truth.size(), 0), weight(scene.points.size());
    FitReport report;
    REQUIRE(fitter->fit(scene.all(), scene.options(900), q.data(), &report,
                        {nullptr, nullptr, weight.data()}) == Status::ok);
    CHECK(scene.turn_error(report.view) < 0.06f);
    int kept = 0, lost = 0;
    for (std::size_t i = 0; i < bad.size(); ++i) {
      kept += bad[i] && weight[i] > 0.5f;
      lost += !bad[i] && weight[i] < 0.1f;
    }
    CHECK(kept <= 2);
    CHECK(lost <= 3);
  }
}

TEST_CASE("an unknown focal length is found within what the image determines") {
  const Scene scene(3, 0.1f, 0.3f);
  InArena<Fitter> fitter(scene.model, limits());
  std::vector<float> q(scene.truth.size(), 0);
  FitReport report;
  REQUIRE(fitter->fit(scene.all(), scene.options(0), q.data(), &report) == Status::ok);
  CHECK(report.rms_px < 0.3f);
  CHECK(camera_of(report.view).f > 600);
  CHECK(camera_of(report.view).f < 1400);
}

TEST_CASE("frozen parameters stay, limits hold") {
  Scene scene(4);
  InArena<Fitter> fitter(scene.model, limits());
  std::vector<float> q(scene.truth.size(), 0);
  std::vector<std::uint8_t> is_free(q.size(), 1);
  is_free[2] = 0;
  q[2] = 0.75f;
  for (Correspondence& c : scene.points) c.x = c.x + Vec2{0, 40 * c.uv.y * c.uv.y};  // pulls past every limit
  FitOptions options = scene.options(900);
  options.is_free = is_free.data();
  FitReport report;
  REQUIRE(fitter->fit(scene.all(), options, q.data(), &report) == Status::ok);
  CHECK(q[2] == 0.75f);
  for (std::size_t k = 0; k < q.size(); ++k) {
    CHECK(q[k] >= scene.model.parameters()[k].minimum);
    CHECK(q[k] <= scene.model.parameters()[k].maximum);
  }
}

TEST_CASE("points that would fold the surface over are followed only up to the fold-over") {
  // A sheet that folds over at a slide of 5. One parameter alone stays below that within its limits; two together exceed it.
  ModelBuilder b;
  b.record(Operation::constant, {}, {}, b.field(3, 17, 17, [](float u, float v) {
    return Vec3{100 * u - 50, 50 - 100 * v, 20 * (u - 0.5f) * (v - 0.5f)};
  }));
  for (const char* name : {"slide", "more"}) {
    const std::uint16_t slide = b.parameter(name, Group::expression, -4, 4, 2);
    b.record(Operation::add_vector, {b.last()}, {slide}, b.field(3, 17, 17, [](float u, float) {
      return Vec3{10 * (u < 0.5f ? 2 * u : 2 - 2 * u), 0, 0};
    }));
  }
  b.grid_mesh(8);
  b.landmark("p", 0.5f, 0.5f);
  const OpenModel sheet(b);
  const Model& model = sheet.model;
  InArena<Cascade> cascade(model);
  InArena<FoldOverTest> test(model);
  test->start(cascade.object);
  const View view = view_of({exp_rotation({0.3f, 0.4f, 0}), {0, 0, 600}}, centred_camera(640, 480, 900));
  for (float pull : {2.0f, 3.5f, 7.5f, 20.0f}) {
    std::vector<Correspondence> points;
    for (int j = 0; j <= 8; ++j)
      for (int i = 0; i <= 8; ++i) {
        Correspondence c{{0.125f * static_cast<float>(i), 0.125f * static_cast<float>(j)}, {}, 0.1f};
        Vec3 p = cascade->surface_point(c.uv, std::vector<float>(2, 0.0f).data());
        p.x += pull * 10 * (c.uv.x < 0.5f ? 2 * c.uv.x : 2 - 2 * c.uv.x);
        REQUIRE(Projector(view, true).project(p, &c.x));
        points.push_back(c);
      }
    InArena<Fitter> fitter(model, limits());
    FitOptions options;
    options.width = 640;
    options.height = 480;
    options.focal_px = 900;
    options.start = &view;
    options.robust = false;
    std::vector<float> q(2, 0.0f);
    FitReport report;
    REQUIRE(fitter->fit({points.data(), points.size()}, options, q.data(), &report) == Status::ok);
    std::vector<Vec3> position(test->vertex_count());
    test->compute_positions(cascade.object, q.data(), position.data());
    CHECK(test->count_folded(position.data()) == 0);
    if (pull < 5) CHECK(q[0] + q[1] == doctest::Approx(double(pull)).epsilon(0.02));
    if (pull > 5) CHECK(q[0] + q[1] > 4.5f);
    q.assign(2, 3.9f);  // starts folded over
    REQUIRE(fitter->fit({points.data(), points.size()}, options, q.data(), &report) == Status::ok);
    test->compute_positions(cascade.object, q.data(), position.data());
    CHECK(test->count_folded(position.data()) == 0);
  }
}

TEST_CASE(
    "the preconditioned dynamics reaches the fit of Gauss-Newton; the published step, in pixels, does not") {
  const Scene scene(9, 0.3f, 0.3f);
  InArena<Fitter> fitter(scene.model, limits());
  FitOptions options = scene.options(900);
  options.robust = false;
  std::vector<float> q(scene.truth.size(), 0), best(q), published(q);
  FitReport report, exact;
  REQUIRE(fitter->fit(scene.all(), options, best.data(), &exact) == Status::ok);
  options.method = FitMethod::euler;
  options.euler.step = EulerStep::barzilai_borwein;
  REQUIRE(fitter->fit(scene.all(), options, q.data(), &report) == Status::ok);
  CHECK(report.rms_px == doctest::Approx(double(exact.rms_px)).epsilon(0.02));
  for (std::size_t k = 0; k < q.size(); ++k)
    CHECK(magnitude(q[k] - best[k]) < 0.1f * scene.model.parameters()[k].sd);
  options.euler.step = EulerStep::published;
  REQUIRE(fitter->fit(scene.all(), options, published.data(), &report) == Status::ok);
  CHECK(report.rms_px > 1.2f * exact.rms_px);
}

TEST_CASE("without stiffness the prior does not hold the parameters back") {
  const Scene scene(10, 0, 0.3f);
  InArena<Fitter> fitter(scene.model, limits());
  FitOptions options = scene.options(900);
  options.robust = false;
  double size[2];
  for (int free = 0; free < 2; ++free) {
    options.stiffness = free == 1 ? 0.0f : 1e6f;
    std::vector<float> q(scene.truth.size(), 0);
    FitReport report;
    REQUIRE(fitter->fit(scene.all(), options, q.data(), &report) == Status::ok);
    size[free] = 0;
    for (std::size_t k = 0; k < q.size(); ++k) {
      size[free] += double(magnitude(q[k]));
      if (free == 1) CHECK(magnitude(q[k] - scene.truth[k]) < 0.05f * scene.model.parameters()[k].sd);
    }
  }
  CHECK(size[0] < 0.1 * size[1]);
  options.stiffness = -1;
  std::vector<float> q(scene.truth.size(), 0);
  FitReport report;
  CHECK(fitter->fit(scene.all(), options, q.data(), &report) == Status::bad_argument);
}

TEST_CASE("without stiffness, a parameter that no point moves has its prior's deviation, not none") {
  const Scene scene(10, 0, 0.3f);
  InArena<Fitter> fitter(scene.model, limits());
  FitOptions options = scene.options(900);
  options.stiffness = 0;
  // Six points say less than there are parameters.
  auto some = scene.points;
  some.resize(6);
  std::vector<float> q(scene.truth.size(), 0), sd(scene.truth.size(), -1);
  FitReport report;
  FitDetails details;
  details.sd = sd.data();
  REQUIRE(fitter->fit({some.data(), some.size()}, options, q.data(), &report, details) == Status::ok);
  REQUIRE(report.undetermined > 0);
  std::size_t open = 0;
  for (std::size_t k = 0; k < sd.size(); ++k) {
    CHECK(sd[k] > 0);
    CHECK(sd[k] <= scene.model.parameters()[k].sd);
    open += sd[k] == scene.model.parameters()[k].sd;
  }
  CHECK(open >= report.undetermined);
}

TEST_CASE("points on one line of the image do not determine a pose, in any direction and with any noise") {
  Scene scene(11, 0, 0.2f);
  InArena<Fitter> fitter(scene.model, limits());
  Random random(4);
  for (int trial = 0; trial < 20; ++trial) {
    const float angle = 0.3f * static_cast<float>(trial), noise = trial % 2 == 0 ? 0.0f : 1.0f;
    const Vec2 along{1 - 0.05f * angle * angle, angle}, across{-angle, 1 - 0.05f * angle * angle};
    auto points = scene.points;
    for (Correspondence& c : points) {
      c.sd_px = 1;
      c.x = Vec2{320, 240} + random.uniform(-100, 100) * along +
            noise / length(across) * random.normal() * across;
    }
    std::vector<float> q(scene.truth.size(), 0.25f);
    FitReport report;
    CHECK(fitter->fit({points.data(), points.size()}, scene.options(900), q.data(), &report) ==
          Status::underdetermined);
    for (float v : q) CHECK(v == 0.25f);
  }
}

TEST_CASE("192 parameters fit at once") {
  const OpenedEgg egg(188);
  const Model& model = egg.model;
  REQUIRE(model.parameters().count == 192);
  Random random(12);
  std::vector<float> truth;
  for (const Parameter& p : model.parameters())
    truth.push_back(clamp(0.3f * p.sd * random.normal(), p.minimum, p.maximum));
  InArena<Cascade> cascade(model);
  const View view = view_of({exp_rotation({0.1f, 0.3f, 0}), {0, 0, 800}}, centred_camera(640, 480, 900));
  std::vector<Correspondence> points;
  while (points.size() < 160) {
    Correspondence c{{random.uniform(0, 1), random.uniform(0, 1)}, {}, 0.2f};
    REQUIRE(Projector(view, true).project(cascade->surface_point(c.uv, truth.data()), &c.x));
    points.push_back(c);
  }
  InArena<Fitter> fitter(model, FitLimits{});
  FitOptions options;
  options.width = 640;
  options.height = 480;
  options.misfit_mm = 0;
  std::vector<float> q(192, 0.0f), sd(192);
  FitReport report;
  REQUIRE(fitter->fit({points.data(), points.size()}, options, q.data(), &report, {sd.data()}) == Status::ok);
  CHECK(report.rms_px < 0.3f);
  CHECK(report.used == 160);
  for (std::size_t k = 0; k < 192; ++k) {
    CHECK(sd[k] > 0);
    CHECK(sd[k] <= model.parameters()[k].sd);
  }
}

TEST_CASE("a parameter that no point sees stays at rest and keeps its prior's deviation") {
  Scene scene(13, 0.2f, 0.3f);
  auto points = scene.points;
  points.erase(
      std::remove_if(points.begin(), points.end(), [](const Correspondence& c) { return c.uv.x < 0.5f; }),
      points.end());
  InArena<Fitter> fitter(scene.model, limits());
  std::vector<float> q(scene.truth.size(), 0), sd(q.size());
  FitReport report;
  FitOptions options = scene.options(900);
  options.misfit_mm = 0;
  REQUIRE(fitter->fit({points.data(), points.size()}, options, q.data(), &report, {sd.data()}) == Status::ok);
  const std::size_t left = scene.model.find_parameter("bumpLeft"),
                    right = scene.model.find_parameter("bumpRight");
  CHECK(sd[right] == doctest::Approx(double(scene.model.parameters()[right].sd)));
  CHECK(magnitude(q[right]) < 1e-4f);
  CHECK(sd[left] < 0.2f * scene.model.parameters()[left].sd);
  CHECK(report.used + 5 > points.size());
}

TEST_CASE("five points give a pose") {
  const Scene scene(5, 0, 0.3f);
  InArena<Fitter> fitter(scene.model, limits());
  const std::size_t chosen[5] = {20, 24, 40, 57, 59};
  std::vector<Correspondence> points;
  for (std::size_t i : chosen) points.push_back(scene.points[i]);
  std::vector<float> q(scene.truth.size(), 0);
  FitReport report;
  REQUIRE(fitter->fit({points.data(), 5}, scene.options(900), q.data(), &report) == Status::ok);
  CHECK(scene.turn_error(report.view) < 0.25f);
}

TEST_CASE("bad input is named and changes nothing") {
  Scene scene(6);
  InArena<Fitter> fitter(scene.model, limits());
  std::vector<float> q(scene.truth.size(), 0.25f);
  FitReport report;
  const auto fit = [&](Span<const Correspondence> points, const FitOptions& o) {
    return fitter->fit(points, o, q.data(), &report);
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  CHECK(fit({scene.points.data(), 3}, scene.options(900)) == Status::too_few_points);
  CHECK(fit(scene.all(), FitOptions{}) == Status::bad_argument);
  CHECK(fit({nullptr, 5}, scene.options(900)) == Status::bad_argument);
  CHECK(fit(scene.all(), scene.options(nan)) == Status::bad_argument);
  scene.points[7].x.y = nan;
  CHECK(fit(scene.all(), scene.options(900)) == Status::bad_argument);
  scene.points[7] = scene.points[6];
  scene.points[8].sd_px = 0;
  CHECK(fit(scene.all(), scene.options(900)) == Status::bad_argument);
  scene.points.resize(200, scene.points[0]);
  for (auto& p : scene.points) p = scene.points[0];
  CHECK(fit(scene.all(), scene.options(900)) == Status::capacity);
  CHECK(fit({scene.points.data(), 50}, scene.options(900)) == Status::underdetermined);  // all the same point
  for (float v : q) CHECK(v == 0.25f);
  const Scene again(6);
  const Correspondence four[] = {again.points[0], again.points[8], again.points[72], again.points[80]};
  CHECK(fit({four, 4}, scene.options(900)) == Status::ok);  // the least
}

TEST_CASE("a known focal length stays, also where the points are then nearer or farther than any view") {
  const Scene scene(7);
  InArena<Fitter> fitter(scene.model, limits());
  for (const float focal : {10.0f, 900.0f, 1e6f}) {
    std::vector<float> q(scene.truth.size(), 0);
    FitReport report;
    REQUIRE(fitter->fit(scene.all(), scene.options(focal), q.data(), &report) == Status::ok);
    CHECK(camera_of(report.view).f == doctest::Approx(static_cast<double>(focal)).epsilon(1e-3));
  }
}

TEST_CASE("a start that is no view is refused, and so is a misfit that is no length") {
  const Scene scene(7);
  InArena<Fitter> fitter(scene.model, limits());
  FitOptions options = scene.options(900);
  View start = scene.view;
  options.start = &start;
  const auto status = [&] {
    std::vector<float> q(scene.truth.size(), 0);
    FitReport report;
    const Status fitted = fitter->fit(scene.all(), options, q.data(), &report);
    CHECK((fitted == Status::ok) == (report.used > 0));
    start = scene.view;
    return fitted;
  };
  CHECK(status() == Status::ok);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const float scale : {-1.0f, 0.0f, nan}) {
    start.s = scale;
    CHECK(status() == Status::bad_argument);
  }
  for (const float rho : {-1.0f, 0.0f, 1.0f, nan}) {
    start.rho = rho;
    CHECK(status() == Status::bad_argument);
  }
  start.q = {0, 0, 0, 0};
  CHECK(status() == Status::bad_argument);
  for (float Vec2::*const along : {&Vec2::x, &Vec2::y}) {
    start.c.*along = nan;
    CHECK(status() == Status::bad_argument);
  }
  for (const float misfit : {-1.0f, nan}) {
    options.misfit_mm = misfit;
    CHECK(status() == Status::bad_argument);
  }
}

TEST_CASE("free parameters come back within their ranges, also from values outside that no step improves") {
  Scene scene(9);
  scene.truth[0] = 5;  // the range is -3 to 3
  InArena<Cascade> cascade(scene.model);
  for (Correspondence& c : scene.points)
    REQUIRE(Projector(scene.view, true).project(cascade->surface_point(c.uv, scene.truth.data()), &c.x));
  InArena<Fitter> fitter(scene.model, limits());
  FitOptions options = scene.options(900);
  options.start = &scene.view;
  options.stiffness = 0;
  std::vector<float> q = scene.truth;
  FitReport report;
  REQUIRE(fitter->fit(scene.all(), options, q.data(), &report) == Status::ok);
  CHECK(q[0] <= 3);
}

TEST_CASE("a point behind the camera is no inlier") {
  Scene scene(8);
  const View close = view_of({{}, {0, 0, 70}}, centred_camera(640, 480, 900));
  InArena<Cascade> cascade(scene.model);
  std::size_t visible = 0;
  for (Correspondence& c : scene.points)
    visible += Projector(close, true).project(cascade->surface_point(c.uv, scene.truth.data()), &c.x);
  REQUIRE((visible > 70 && visible < scene.points.size()));
  InArena<Fitter> fitter(scene.model, limits());
  FitOptions options = scene.options(900);
  options.start = &close;
  std::vector<float> q = scene.truth;
  FitReport report;
  REQUIRE(fitter->fit(scene.all(), options, q.data(), &report) == Status::ok);
  CHECK(report.used <= visible);
}

TEST_CASE(
    "a prior that is stronger than the points takes parameters back to the mean from where they start") {
  const Scene scene(4);
  InArena<Fitter> fitter(scene.model, limits());
  std::vector<float> q = scene.truth;  // the points would leave them there
  FitOptions options = scene.options(900);
  options.start = &scene.view;
  options.stiffness = 1e6f;
  FitReport report;
  REQUIRE(fitter->fit(scene.all(), options, q.data(), &report) == Status::ok);
  for (std::size_t k = 0; k < q.size(); ++k) CHECK(magnitude(q[k]) < 0.02f * scene.model.parameters()[k].sd);
  CHECK(report.rms_px > 0.5f);
}

}  // namespace fit_test
