#include "pliant/fold_over.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "open_model.hpp"
#include "random.hpp"

namespace fold_over_test {

using namespace pliant;

namespace {

/// A sheet of 100 x 100 mm whose points slide along u by q * 10 mm * tent(u), a tent of slope +-2 around the middle: the
/// second half folds when 100 - 20 q < 0 there, at q = 5. The second parameter lifts it and never folds it.
ModelBuilder sheet(float limit) {
  ModelBuilder b;
  b.record(Operation::constant, {}, {}, b.field(3, 17, 17, [](float u, float v) {
    return Vec3{100 * u, -100 * v, 0};
  }));
  const std::uint16_t slide = b.parameter("slide", Group::expression, -limit, limit, 1);
  b.record(Operation::add_vector, {b.last()}, {slide}, b.field(3, 17, 17, [](float u, float) {
    return Vec3{10 * (u < 0.5f ? 2 * u : 2 - 2 * u), 0, 0};
  }));
  const std::uint16_t lift = b.parameter("lift", Group::identity, -3, 3, 1);
  b.record(Operation::add_vector, {b.last()}, {lift}, b.field(3, 17, 17, [](float u, float v) {
    return Vec3{0, 0, 40 * u * v};
  }));
  b.grid_mesh(8);
  b.landmark("p", 0.5f, 0.5f);
  return b;
}

struct Tested : OpenModel {
  InArena<Cascade> cascade;
  InArena<FoldOverTest> test;
  explicit Tested(const ModelBuilder& builder) : OpenModel(builder), cascade(model), test(model) {
    test->start(cascade.object);
  }
  std::vector<Vec3> at(const std::vector<float>& q) {
    std::vector<Vec3> p(test->vertex_count());
    test->compute_positions(cascade.object, q.data(), p.data());
    return p;
  }
};

}  // namespace

TEST_CASE(
    "a sliding sheet folds where the derivative along u changes its sign, and a step may go nine tenths of "
    "the way") {
  Tested t(sheet(4));
  CHECK(t.test->watched_count() == 128);
  const auto rest = t.at({0, 0});
  CHECK(t.test->count_folded(rest.data()) == 0);
  CHECK(t.test->count_folded(t.at({4.99f, 0}).data()) == 0);
  CHECK(t.test->count_folded(t.at({5.01f, 0}).data()) == 64);
  CHECK(t.test->count_folded(t.at({-5.01f, 0}).data()) == 64);
  CHECK(t.test->step_fraction(rest.data(), t.at({4.99f, 3}).data()) == 1);
  CHECK(t.test->step_fraction(rest.data(), t.at({10, 0}).data()) == doctest::Approx(0.9 * 0.5).epsilon(1e-3));
  CHECK(t.test->step_fraction(rest.data(), t.at({-20, 2}).data()) ==
        doctest::Approx(0.9 * 0.25).epsilon(1e-3));
  CHECK(t.test->step_fraction(t.at({3, 0}).data(), t.at({7, 0}).data()) ==
        doctest::Approx(0.9 * 0.5).epsilon(1e-3));
  // Faces that have folded over already do not limit the step back.
  CHECK(t.test->step_fraction(t.at({6, 0}).data(), rest.data()) == 1);
}

TEST_CASE(
    "the area of a face is of the second degree along a step: its first root limits, and without one none "
    "does") {
  Tested t(sheet(4));
  const auto rest = t.at({0, 0});
  const auto fraction_to = [&](auto place) {
    std::vector<Vec3> to;
    for (const Vec3& p : rest) to.push_back(place(p));
    return t.test->step_fraction(rest.data(), to.data());
  };
  // (1 - 2 a) (1 - 4 a) of the area at rest.
  CHECK(fraction_to([](Vec3 p) {
          return Vec3{-p.x, -3 * p.y, 0};
        }) == doctest::Approx(0.9 * 0.25).epsilon(1e-3));
  // A turn by a right angle: (1 - a)^2 + a^2.
  CHECK(fraction_to([](Vec3 p) { return Vec3{-p.y, p.x, 0}; }) == 1);
}

TEST_CASE("a step that folds a face over is never taken whole, however near its end the fold is") {
  Tested t(sheet(4));
  Random random(7);
  for (int trial = 0; trial < 300; ++trial) {
    const float lift = random.uniform(-3, 3);
    float unfolded = 4.9f, folded = 5.1f;
    for (int k = 0; k < 14 + trial % 8; ++k) {
      const float middle = 0.5f * (unfolded + folded);
      (t.test->count_folded(t.at({middle, lift}).data()) > 0 ? folded : unfolded) = middle;
    }
    // The root of the area along the step is rounded.
    const auto to = t.at({folded, lift});
    REQUIRE(t.test->count_folded(to.data()) > 0);
    for (const float before : {unfolded, 4.99f, 4.0f, 0.0f, -2.0f}) {
      const auto from = t.at({before, before == unfolded ? lift : random.uniform(-3, 3)});
      CHECK(t.test->step_fraction(from.data(), to.data()) < 1);
    }
  }
}

TEST_CASE("the normals of the surface itself say the same at every point") {
  Tested t(sheet(4));
  const std::vector<float> rest{0, 0}, good{4.9f, 1}, bad{5.1f, 0};
  for (float u : {0.1f, 0.3f, 0.6f, 0.9f}) {
    const Vec2 uv{u, 0.4f};
    const SurfaceFrame at_rest = t.cascade->surface_frame(uv, rest.data());
    CHECK(orientation(t.cascade->surface_frame(uv, good.data()), at_rest) > 0);
    CHECK((orientation(t.cascade->surface_frame(uv, bad.data()), at_rest) > 0) == (u < 0.5f));
  }
}

TEST_CASE("faces that a parameter folds over within its own limits are not watched") {
  Tested t(sheet(5.5f));
  CHECK(t.test->watched_count() == 0);  // to -5.5 one half folds, to 5.5 the other
  CHECK(t.test->count_folded(t.at({5.4f, 0}).data()) == 0);
  CHECK(t.test->step_fraction(t.at({0, 0}).data(), t.at({20, 0}).data()) == 1);
}

TEST_CASE("measured at rest alone every face is watched") {
  Tested t(sheet(5.5f));
  t.test->start_at_rest(t.cascade.object);
  CHECK(t.test->is_started());
  CHECK(t.test->watched_count() == 128);
  CHECK(t.test->count_folded(t.at({5.4f, 0}).data()) == 64);
  CHECK(t.test->step_fraction(t.at({0, 0}).data(), t.at({4.99f, 0}).data()) == 1);
  CHECK(t.test->step_fraction(t.at({0, 0}).data(), t.at({20, 0}).data()) ==
        doctest::Approx(0.9 * 0.25).epsilon(1e-3));
  t.test->start(t.cascade.object);
  CHECK(t.test->watched_count() == 0);
}

TEST_CASE("random steps of a model with rotations end unfolded when what they lead to is checked again") {
  Tested t(egg_model(6));
  Random random(2);
  int limited = 0;
  for (int trial = 0; trial < 60; ++trial) {
    std::vector<float> q(t.model.parameters().count), to(q.size());
    for (std::size_t k = 0; k < q.size(); ++k) {
      const Parameter& p = t.model.parameters()[k];
      q[k] = 0.3f * random.uniform(p.minimum, p.maximum);
      to[k] = q[k] + 12 * random.uniform(p.minimum, p.maximum);  // far beyond the limits
    }
    const auto from = t.at(q);
    REQUIRE(t.test->count_folded(from.data()) == 0);
    float fraction = 1;
    std::vector<Vec3> there = t.at(to);
    for (int k = 0; k < 8; ++k) {
      const float f = t.test->step_fraction(from.data(), there.data());
      CHECK(f >= 0);
      if (f == 1) break;
      fraction *= f;
      std::vector<float> part(q);
      for (std::size_t i = 0; i < q.size(); ++i) part[i] += fraction * (to[i] - q[i]);
      there = t.at(part);
    }
    limited += fraction < 1;
    CHECK(t.test->count_folded(there.data()) == 0);
  }
  CHECK(limited > 20);
}

TEST_CASE("positions that are not numbers count as folded") {
  Tested t(sheet(4));
  auto p = t.at({0, 0});
  p[40].x = std::numeric_limits<float>::quiet_NaN();
  CHECK(t.test->count_folded(p.data()) > 0);
}

}  // namespace fold_over_test
