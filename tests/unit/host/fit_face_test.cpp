// The fit on the built-in face.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "baked_face.hpp"
#include "model_builder.hpp"
#include "pliant/fit.hpp"
#include "pliant/fold_over.hpp"
#include "random.hpp"

namespace fit_face_test {

using namespace pliant;

namespace {

bool is_jaw_name(const char* name) {
  return std::strncmp(name, "ibug", 4) == 0 && std::atoi(name + 4) <= 16;
}

/// A random person seen from the side, with the 68 landmarks as a person would mark them: silhouette landmarks are on the
/// silhouette in the picture.
struct Portrait {
  BakedModel& face = baked_face();
  std::vector<float> truth;
  View view;
  std::vector<Correspondence> points;

  Portrait(std::uint64_t seed, float yaw) : truth(face.rest()) {
    Random random(seed);
    for (std::size_t k = 0; k < truth.size(); ++k) {
      const Parameter& p = face.model.parameters()[k];
      if (p.group == Group::identity) truth[k] = clamp(p.sd * random.normal(), p.minimum, p.maximum);
    }
    view = view_of({exp_rotation({random.uniform(-0.1f, 0.1f), yaw, random.uniform(-0.1f, 0.1f)}),
                    {random.uniform(-20, 20), random.uniform(-20, 20), 800}},
                   centred_camera(640, 480, 900));
    const Projector projector(view, true);
    for (const Landmark& l : face.model.landmarks()) {
      if (std::strncmp(l.name, "ibug", 4) != 0) continue;
      const bool is_silhouette = is_jaw_name(l.name);
      Correspondence c{l.uv(), {}, 0.5f, is_silhouette};
      const Vec2 seen = is_silhouette ? where_it_turns_away(projector, c.uv) : c.uv;
      REQUIRE(projector.project(face.at(seen, truth), &c.x));
      c.x = c.x + Vec2{0.5f * random.normal(), 0.5f * random.normal()};
      points.push_back(c);
    }
  }
  float facing(const Projector& projector, Vec2 uv) {
    const SurfaceFrame f = face.cascade.surface_frame(uv, truth.data());
    const Vec3 n = projector.rotated(normalised(cross(f.pv, f.pu)));
    return -dot(n, normalised(projector.to_camera(f.p)));
  }
  /// The place itself, or, when it has turned away, the nearest along v = constant that has not.
  Vec2 where_it_turns_away(const Projector& projector, Vec2 uv) {
    for (int k = 0; k <= 400; ++k) {
      const Vec2 at{uv.x + (0.5f - uv.x) * static_cast<float>(k) / 400, uv.y};
      if (facing(projector, at) >= 0) return at;
    }
    return uv;
  }
  /// Turn (rad) and shape (mm rms over the base mesh) between a fit and the truth.
  void errors(const FitReport& report, const std::vector<float>& q, double* turn, double* shape) {
    *turn = double(length(log_rotation(report.view.q * conjugate(view.q))));
    double sum = 0;
    for (Vec2 uv : face.model.base_uv()) {
      const Vec3 d = face.at(uv, q) - face.at(uv, truth);
      sum += double(dot(d, d));
    }
    *shape = std::sqrt(sum / double(face.model.base_uv().count));
  }
};

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v[v.size() / 2];
}

}  // namespace

TEST_CASE(
    "silhouette landmarks that may move along the silhouette give a better pose and shape than fixed ones") {
  std::vector<double> turn[2], shape[2];
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Portrait portrait(seed, seed % 2 == 0 ? 0.52f : -0.52f);
    std::vector<std::uint8_t> identity;
    for (const Parameter& p : portrait.face.model.parameters())
      identity.push_back(p.group == Group::identity);
    for (int matched = 0; matched < 2; ++matched) {
      FitLimits limits;
      limits.silhouette = true;
      InArena<Fitter> fitter(portrait.face.model, limits);
      auto points = portrait.points;
      for (Correspondence& c : points) c.is_silhouette = c.is_silhouette && matched == 1;
      FitOptions options;
      options.width = 640;
      options.height = 480;
      options.focal_px = 900;
      options.is_free = identity.data();
      std::vector<float> q = portrait.face.rest();
      FitReport report;
      REQUIRE(fitter->fit({points.data(), points.size()}, options, q.data(), &report) == Status::ok);
      double t, s;
      portrait.errors(report, q, &t, &s);
      turn[matched].push_back(t);
      shape[matched].push_back(s);
    }
  }
  std::printf(
      "silhouette at 30 degrees: turn %.2f degrees held, %.2f matched; shape %.2f mm held, %.2f matched\n",
      57.3 * median(turn[0]), 57.3 * median(turn[1]), median(shape[0]), median(shape[1]));
  CHECK(median(turn[1]) < 0.25 * median(turn[0]));
  CHECK(median(turn[1]) < 0.02);
  CHECK(median(shape[1]) < 0.5 * median(shape[0]));
}

TEST_CASE(
    "the built-in face has no fold-over after a fit to random points, and steps to its limits stop before "
    "one") {
  BakedModel& face = baked_face();
  InArena<FoldOverTest> test(face.model);
  test->start(face.cascade);
  std::vector<Vec3> position(test->vertex_count()), rest(position);
  test->compute_positions(face.cascade, face.rest().data(), rest.data());
  CHECK(test->watched_count() + 5 >
        face.model.base_corners().count / 3);  // only what its own limits fold is left out
  Random random(8);
  int folded = 0;
  for (int trial = 0; trial < 40; ++trial) {  // every parameter at one of its limits at once
    std::vector<float> q = face.rest();
    for (std::size_t k = 0; k < q.size(); ++k) {
      const Parameter& p = face.model.parameters()[k];
      q[k] = random.below(2) == 0 ? p.minimum : p.maximum;
    }
    test->compute_positions(face.cascade, q.data(), position.data());
    folded += test->count_folded(position.data()) > 0;
    float fraction = 1;
    for (int k = 0; k < 8; ++k) {
      const float f = test->step_fraction(rest.data(), position.data());
      if (f == 1) break;
      fraction *= f;
      std::vector<float> part(q);
      for (float& v : part) v *= fraction;
      test->compute_positions(face.cascade, part.data(), position.data());
    }
    CHECK(test->count_folded(position.data()) == 0);
    CHECK(fraction > 0.1f);
  }
  std::printf("all parameters at random limits: %d of 40 fold the built-in face\n", folded);
  CHECK(folded > 0);
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    Portrait portrait(seed, 0.2f);
    for (Correspondence& c : portrait.points) c.x = c.x + Vec2{60 * random.normal(), 60 * random.normal()};
    FitLimits limits;
    limits.silhouette = true;
    InArena<Fitter> fitter(face.model, limits);
    FitOptions options;
    options.width = 640;
    options.height = 480;
    options.misfit_mm = 0.1f;
    options.robust = seed % 2 == 0;
    std::vector<float> q = face.rest();
    FitReport report;
    if (fitter->fit({portrait.points.data(), portrait.points.size()}, options, q.data(), &report) !=
        Status::ok)
      continue;
    test->compute_positions(face.cascade, q.data(), position.data());
    CHECK(test->count_folded(position.data()) == 0);
  }
}

TEST_CASE("a fitter without room for silhouette points refuses them") {
  Portrait portrait(1, 0);
  InArena<Fitter> fitter(portrait.face.model, FitLimits{});
  FitOptions options;
  options.width = 640;
  options.height = 480;
  std::vector<float> q = portrait.face.rest();
  FitReport report;
  CHECK(fitter->fit({portrait.points.data(), portrait.points.size()}, options, q.data(), &report) ==
        Status::bad_argument);
}

}  // namespace fit_face_test
