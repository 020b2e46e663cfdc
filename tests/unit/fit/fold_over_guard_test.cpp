// Parameters that fold the surface over are moved back towards the last valid ones.
#include "fit/fold_over_guard.hpp"

#include <doctest/doctest.h>

#include "model_builder.hpp"
#include "random.hpp"

namespace fold_over_guard_test {

using namespace pliant;

namespace {

/// A sheet of 100 x 100 mm whose points slide along u by q * 10 mm * tent(u), with q the sum of two parameters between
/// -limit and limit: half of it folds over at q = 5.
std::vector<std::uint32_t> sheet(float limit) {
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
  return b.table();
}

struct Guarded {
  std::vector<std::uint32_t> words;
  Model model;
  explicit Guarded(float limit = 4) : words(sheet(limit)) {
    REQUIRE(Model::open(words.data(), words.size() * 4, &model) == Status::ok);
  }
  /// Runs `check(cascade, guard)` without and with samples of the base mesh.
  template <class Check>
  void run(Check&& check) const {
    for (const bool samples : {false, true}) {
      CAPTURE(samples);
      InArena<Cascade> cascade(model);
      InArena<FoldOverGuard> guard(model, samples);
      check(cascade.object, guard.object);
    }
  }
};

}  // namespace

TEST_CASE("a valid state stays, a folded one moves back to nine tenths of the way to the fold") {
  const Guarded g;
  g.run([&](Cascade& cascade, FoldOverGuard& guard) {
    float q[2] = {2, 2};
    guard.start(cascade, q);
    CHECK_FALSE(guard.move_back(q));
    CHECK(q[0] == 2);
    q[0] = q[1] = 4;  // 8 in all; from 4 the fold at 5 is a quarter of the way
    CHECK(guard.move_back(q));
    CHECK(double(q[0] + q[1]) == doctest::Approx(4 + 0.9 * 1).epsilon(0.01));
    CHECK(double(q[0]) == doctest::Approx(double(q[1])));
    const std::size_t last = g.model.base_uv().count - 1;
    for (const std::size_t v : {std::size_t{0}, last})
      CHECK(length(guard.positions()[v] - cascade.surface_point(g.model.base_uv()[v], q)) < 1e-3f);
  });
}

TEST_CASE("a fold that one parameter makes within its limits is meant, and stays") {
  const Guarded g(5.5f);
  g.run([&](Cascade& cascade, FoldOverGuard& guard) {
    float q[2] = {2, 2};
    guard.start(cascade, q);
    CHECK_FALSE(guard.move_back(q));
    for (const float sum : {5.2f, 9.0f}) {
      q[0] = q[1] = 0.5f * sum;
      CHECK_FALSE(guard.move_back(q));
      CHECK(q[0] == 0.5f * sum);
    }
  });
}

TEST_CASE("frozen parameters are part of the valid state; free ones start at rest") {
  const Guarded g;
  g.run([&](Cascade& cascade, FoldOverGuard& guard) {
    const std::uint8_t is_free[] = {0, 1};
    for (int turn = 0; turn < 2; ++turn) {  // samples of frozen parameters are no others' samples
      cascade.set_all_free();
      float free[2] = {2, 2};
      guard.start(cascade, free);
      CHECK_FALSE(guard.move_back(free));
      cascade.set_free(is_free);
      float q[2] = {turn == 0 ? 3.0f : 2.0f, 4};  // together 7 and 6: folded
      const float frozen = q[0];
      guard.start(cascade, q);
      CHECK(guard.move_back(q));
      CHECK(q[0] == frozen);
      CHECK(q[1] > 0);
      CHECK(q[0] + q[1] < 5);
      CHECK(q[0] + q[1] > 4);
    }
  });
}

}  // namespace fold_over_guard_test
