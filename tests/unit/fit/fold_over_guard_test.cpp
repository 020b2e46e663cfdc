// Parameters that fold the surface over are moved back towards the last valid ones.
#include "fit/fold_over_guard.hpp"

#include <doctest/doctest.h>

#include "open_model.hpp"
#include "random.hpp"

namespace fold_over_guard_test {

using namespace pliant;

namespace {

/// A sheet of 100 x 100 mm whose points slide along u by q * 10 mm * tent(u), with q the sum of two parameters between
/// -limit and limit: half of it folds over at q = 5.
ModelBuilder sheet(float limit) {
  ModelBuilder b;
  b.record(Operation::constant, {}, {}, b.field(3, 17, 17, [](float u, float v) {
    return Vec3{100 * u, -100 * v, 0};
  }));
  for (const char* name : {"first", "second"}) {
    const std::uint16_t q = b.parameter(name, Group::expression, -limit, limit, 1);
    b.record(Operation::add_vector, {b.last()}, {q}, b.field(3, 17, 17, [](float u, float) {
      return Vec3{10 * (u < 0.5f ? 2 * u : 2 - 2 * u), 0, 0};
    }));
  }
  b.grid_mesh(8);
  b.landmark("p", 0.5f, 0.5f);
  return b;
}

struct Guarded : OpenModel {
  InArena<Cascade> cascade;
  InArena<FoldOverGuard> guard;

  explicit Guarded(float limit = 4, bool has_samples = false)
      : OpenModel(sheet(limit)), cascade(model), guard(model, has_samples) {}
  void start(const float* q) { guard->start(cascade.object, q); }
};

}  // namespace

TEST_CASE("a valid state stays, a folded one moves back to nine tenths of the way to the fold") {
  Guarded g;
  float q[2] = {2, 2};
  g.start(q);
  CHECK_FALSE(g.guard->move_back(q));
  CHECK(q[0] == 2);
  q[0] = q[1] = 4;  // 8 in all; from 4 the fold at 5 is a quarter of the way
  CHECK(g.guard->move_back(q));
  CHECK(double(q[0] + q[1]) == doctest::Approx(4 + 0.9 * 1).epsilon(0.01));
  CHECK(double(q[0]) == doctest::Approx(double(q[1])));
  const std::size_t last = g.model.base_uv().count - 1;
  for (const std::size_t v : {std::size_t{0}, last})
    CHECK(length(g.guard->positions()[v] - g.cascade->surface_point(g.model.base_uv()[v], q)) < 1e-3f);
}

TEST_CASE("a fold is told between the state at rest and another one, which is seen with samples and without") {
  for (const bool has_samples : {false, true}) {
    Guarded g(4, has_samples);
    float q[2] = {0, 0};
    g.start(q);
    const std::size_t middle = g.model.base_uv().count / 2;
    for (const float each : {4.0f, 2.4f}) {
      g.guard->expect_shapes();
      q[0] = q[1] = each;
      CHECK(g.guard->has_folded(q) == (2 * each > 5));
      g.guard->see(q);
      const Vec3 at = g.cascade->surface_point(g.model.base_uv()[middle], q);
      CHECK(length(g.guard->positions()[middle] - at) < 1e-3f);
    }
  }
}

TEST_CASE("a fold that one parameter makes within its limits is meant, and stays") {
  Guarded g(5.5f);
  float q[2] = {2, 2};
  g.start(q);
  CHECK_FALSE(g.guard->move_back(q));
  for (const float sum : {5.2f, 9.0f}) {
    q[0] = q[1] = 0.5f * sum;
    CHECK_FALSE(g.guard->has_folded(q));
    CHECK_FALSE(g.guard->move_back(q));
    CHECK(q[0] == 0.5f * sum);
  }
}

TEST_CASE("frozen parameters are part of the valid state; free ones start at rest") {
  Guarded g;
  const std::uint8_t is_free[] = {0, 1};
  for (int turn = 0; turn < 2; ++turn) {  // frozen parameters are those of this start
    g.cascade->set_all_free();
    float free[2] = {2, 2};
    g.start(free);
    CHECK_FALSE(g.guard->move_back(free));
    g.cascade->set_free(is_free);
    float q[2] = {turn == 0 ? 3.0f : 2.0f, 4};  // together 7 and 6: folded
    const float frozen = q[0];
    g.start(q);
    CHECK(g.guard->move_back(q));
    CHECK(q[0] == frozen);
    CHECK(q[1] > 0);
    CHECK(q[0] + q[1] < 5);
    CHECK(q[0] + q[1] > 4);
  }
}

}  // namespace fold_over_guard_test
