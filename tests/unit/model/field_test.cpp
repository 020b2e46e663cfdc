#include <doctest/doctest.h>

#include <initializer_list>

#include "pliant/cascade.hpp"
#include "random_model.hpp"

namespace field_test {

using namespace pliant;

namespace {

/// A directed acyclic graph with every operation, two branches joined by lerp, and every kind of support.
ModelBuilder every_operation() {
  ModelBuilder b = egg_model(1);
  const auto q = [&b](const char* name) { return b.parameter(name, Group::expression, -1, 1, 0.5f); };
  const auto wavy = [](float u, float v) { return Vec3{4 * u * v, 3 * v * v - 2 * u, 5 * u * u * v}; };
  const std::uint16_t v1 = b.field(3, 21, 17, wavy), w1 = b.field(1, 15, 15, [](float u, float v) {
    return Vec3{u * (1 - v), 0, 0};
  });
  const std::uint16_t egg = b.last();
  const std::uint16_t a = q("a"), c = q("c");
  b.record(Operation::product, {egg}, {a, c}, v1);
  b.record(Operation::one_sided, {b.last()}, {q("d")}, v1).axis[0] = 0.3f;
  CascadeRecord& affine = b.record(Operation::affine, {b.last()}, {q("e")}, kNone, w1);
  const float m[12] = {1.1f, 0.2f, 0, -0.1f, 0.9f, 0.3f, 0.05f, 0, 1.2f, 3, -2, 1};
  for (int k = 0; k < 12; ++k) affine.matrix[k] = m[k];
  const std::uint16_t branch = b.last();
  CascadeRecord& rigid =
      b.record(Operation::rigid, {egg}, {q("r0"), q("r1"), q("r2"), q("t0"), q("t1"), q("t2")}, kNone, w1);
  rigid.pivot[0] = 5;
  const std::uint16_t other = b.last();
  b.record(Operation::lerp, {branch, other}, {q("blend")}, kNone, w1);
  CascadeRecord& turn = b.record(Operation::rotate, {b.last()}, {a}, kNone, w1);  // a parameter used twice
  turn.axis[1] = 1;
  return b;
}

}  // namespace

TEST_CASE("Eq. 4: add_vector adds its parameter times its field") {
  const OpenModel r(egg_model(1));
  InArena<Cascade> cascade(r.model);
  std::vector<float> q(r.model.parameters().count, 0.0f);
  const Vec2 uv{0.3f, 0.8f};
  const Vec3 rest = cascade->surface_point(uv, q.data());
  q[0] = 1.5f;
  const Vec3 v = sample(r.model, r.model.fields()[r.model.cascade()[1].field], uv);
  // The later records act on the result, but none of them has a parameter away from zero.
  CHECK(length(cascade->surface_point(uv, q.data()) - rest - 1.5f * v) < 1e-5f);
}

TEST_CASE("Eq. 11: the Jacobian of every operation agrees with central differences") {
  for (const ModelBuilder& b : {egg_model(4), every_operation()}) {
    const OpenModel r(b);
    InArena<Cascade> cascade(r.model);
    const std::size_t n = r.model.parameters().count;
    Random random(7);
    std::vector<Vec3> samples(r.model.cascade().count);
    for (int trial = 0; trial < 100; ++trial) {
      const Vec2 uv{random.uniform(0, 1), random.uniform(0, 1)};
      std::vector<float> q = random_q(r.model, random);
      cascade->sample_point(uv, q.data(), samples.data());
      Jacobian jacobian;
      cascade->evaluate(samples.data(), q.data(), &jacobian);
      std::vector<Vec3> column(n);
      for (std::size_t k = 0; k < jacobian.count; ++k) {
        column[cascade->parameter_of(jacobian.list[k])] = jacobian.column[jacobian.list[k]];
        if (k > 0) CHECK(jacobian.list[k] > jacobian.list[k - 1]);
      }
      for (std::size_t k = 0; k < n; ++k) {
        const float at = q[k], h = 4e-3f;
        q[k] = at + h;
        const Vec3 ahead = cascade->evaluate(samples.data(), q.data());
        q[k] = at - h;
        const Vec3 behind = cascade->evaluate(samples.data(), q.data());
        q[k] = at;
        const Vec3 difference = (0.5f / h) * (ahead - behind);
        CHECK(length(difference - column[k]) < 3e-3f * length(column[k]) + 0.02f);
      }
    }
  }
}

TEST_CASE("the Jacobian of a rigid motion is right for any angle, also beyond half a turn") {
  ModelBuilder b;
  std::vector<std::uint16_t> unknowns;
  for (const char* name : {"r0", "r1", "r2", "t0", "t1", "t2"})
    unknowns.push_back(b.parameter(name, Group::expression, -8, 8, 1));
  b.record(Operation::constant, {}, {}, b.field(3, 9, 9, [](float u, float v) {
    return Vec3{100 * (u - 0.5f), 100 * (0.5f - v), 30 * u * v};
  }));
  b.record(Operation::rigid, {b.last()}, unknowns);
  b.grid_mesh(4);
  const OpenModel r(b);
  InArena<Cascade> cascade(r.model);
  std::vector<Vec3> samples(cascade->samples_per_point());
  for (const float angle : {0.05f, 1.0f, 3.0f, 3.3f, 4.5f, 6.2f, 7.0f}) {
    float q[6] = {0.6f * angle, 0, 0.8f * angle, 1, 2, 3};
    cascade->sample_point({0.9f, 0.2f}, q, samples.data());
    Jacobian jacobian;
    cascade->evaluate(samples.data(), q, &jacobian);
    std::vector<Vec3> column(jacobian.column, jacobian.column + 6);
    for (std::size_t k = 0; k < 6; ++k) {
      const float at = q[k], h = 1e-2f;
      q[k] = at + h;
      const Vec3 ahead = cascade->evaluate(samples.data(), q);
      q[k] = at - h;
      const Vec3 behind = cascade->evaluate(samples.data(), q);
      q[k] = at;
      CHECK(length((0.5f / h) * (ahead - behind) - column[k]) < 3e-3f * length(column[k]) + 0.02f);
    }
  }
}

TEST_CASE("a sampled surface point has the position that the tables give, whatever is frozen") {
  const OpenModel r(every_operation());
  InArena<Cascade> cascade(r.model);
  Random random(8);
  const std::size_t n = r.model.parameters().count;
  std::vector<Vec3> samples(r.model.cascade().count);
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<std::uint8_t> is_free(n);
    for (auto& f : is_free) f = static_cast<std::uint8_t>(random.below(trial % 3 == 0 ? 6 : 2) == 0);
    cascade->set_free(is_free.data());
    REQUIRE(cascade->samples_per_point() <= samples.size());
    std::vector<float> q = random_q(r.model, random);
    const Vec2 uv{random.uniform(0, 1), random.uniform(0, 1)};
    cascade->sample_point(uv, q.data(), samples.data());
    for (std::size_t k = 0; k < n; ++k)
      if (is_free[k]) q[k] = random.uniform(r.model.parameters()[k].minimum, r.model.parameters()[k].maximum);
    Jacobian jacobian;
    const Vec3 exact = cascade->surface_point(uv, q.data());
    CHECK(length(cascade->evaluate(samples.data(), q.data()) - exact) < 1e-4f);
    CHECK(length(cascade->evaluate(samples.data(), q.data(), &jacobian) - exact) < 1e-4f);
    for (std::size_t k = 0; k < jacobian.count; ++k)
      CHECK(is_free[cascade->parameter_of(jacobian.list[k])] == 1);
  }
}

TEST_CASE(
    "with everything frozen a sampled point is one value; with identity frozen, one and the expressions") {
  const OpenModel r(egg_model(6));
  InArena<Cascade> cascade(r.model);
  std::vector<std::uint8_t> none(r.model.parameters().count, 0);
  cascade->set_free(none.data());
  CHECK(cascade->samples_per_point() == 1);
  CHECK(cascade->column_count() == 0);
  cascade->set_free(Group::expression);
  CHECK(cascade->samples_per_point() == 5);
  CHECK(cascade->column_count() == 4);
}

TEST_CASE("selecting the records that do something changes nothing, whichever parameters are zero") {
  const OpenModel r(every_operation());
  InArena<Cascade> cascade(r.model), sampler(r.model);
  Random random(12);
  std::vector<Vec3> samples(r.model.cascade().count);
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<float> q = random_q(r.model, random);
    for (float& v : q)
      if (random.below(3) > 0) v = 0;
    cascade->select(q.data());
    for (int k = 0; k < 4; ++k) {
      const Vec2 uv{random.uniform(0, 1), random.uniform(0, 1)};
      sampler->sample_point(uv, q.data(), samples.data());  // visits every record
      CHECK(length(cascade->selected_point(uv) - sampler->evaluate(samples.data(), q.data())) < 1e-4f);
    }
  }
}

TEST_CASE("with slack a selected point moves by no more than that for each vector that is left out") {
  const OpenModel r(egg_model(6));
  InArena<Cascade> exact(r.model), slack(r.model);
  Random random(13);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<float> q = random_q(r.model, random);
    for (float& v : q) v *= trial % 2 == 0 ? 0.02f : 1.0f;
    const float mm = 0.1f;
    exact->select(q.data());
    slack->select(q.data(), mm);
    const Vec2 uv{random.uniform(0, 1), random.uniform(0, 1)};
    const Vec3 off = slack->selected_point(uv) - exact->selected_point(uv);
    const auto left_out = static_cast<float>(q.size());
    CHECK(length(off) <= 1.74f * mm * left_out);
  }
}

TEST_CASE("with slack a sampled point has fewer columns, and moves by no more than that for each of them") {
  const OpenModel r(egg_model(6));
  InArena<Cascade> exact(r.model), slack(r.model);
  Random random(14);
  std::vector<Vec3> samples(r.model.cascade().count), whole(r.model.cascade().count);
  std::size_t columns = 0, all = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const std::vector<float> q = random_q(r.model, random);
    const Vec2 uv{random.uniform(0, 1), random.uniform(0, 1)};
    slack->sample_point(uv, q.data(), samples.data(), 0.2f);
    exact->sample_point(uv, q.data(), whole.data());
    Jacobian some, every;
    const Vec3 off =
        slack->evaluate(samples.data(), q.data(), &some) - exact->evaluate(whole.data(), q.data(), &every);
    CHECK(length(off) <= 1.74f * 0.2f * static_cast<float>(every.count - some.count) + 1e-4f);
    columns += some.count;
    all += every.count;
  }
  CHECK(columns < all);
}

TEST_CASE(
    "slack leaves out no vector that moves a point by more, and every plain one that moves all by less") {
  const OpenModel r(egg_model(6));
  InArena<Cascade> exact(r.model), slack(r.model);
  std::vector<float> q(r.model.parameters().count, 0.0f);
  for (std::size_t k = 0; k < q.size(); ++k) {
    q[k] = r.model.parameters()[k].maximum;
    Vec3 most{};
    for (float u = 0; u <= 1; u += 0.05f)
      for (float v = 0; v <= 1; v += 0.05f) {
        exact->select(q.data());
        const Vec3 with = exact->selected_point({u, v});
        const float amount = q[k];
        q[k] = 0;
        exact->select(q.data());
        const Vec3 moved = with - exact->selected_point({u, v});
        q[k] = amount;
        if (length(moved) > length(most)) most = moved;
      }
    const float seen = max(magnitude(most.x), max(magnitude(most.y), magnitude(most.z)));
    slack->select(q.data(), 0.5f * seen);  // what moves a point by more than the slack is never left out
    exact->select(q.data());
    for (float u = 0; u <= 1; u += 0.1f)
      CHECK(length(slack->selected_point({u, 0.5f}) - exact->selected_point({u, 0.5f})) == 0);
    const std::vector<float> moved = q;
    q[k] = 0;
    exact->select(q.data());
    slack->select(moved.data(), 1e6f);  // and with room for all, every plain vector
    for (const CascadeRecord& record : r.model.cascade())
      for (float u = 0; u <= 1 && record.operation == Operation::add_vector && record.parameter[0] == k;
           u += 0.1f)
        CHECK(length(slack->selected_point({u, 0.5f}) - exact->selected_point({u, 0.5f})) == 0);
  }
}

TEST_CASE("tangents agree with differences inside a cell, through every operation") {
  const OpenModel r(every_operation());
  InArena<Cascade> cascade(r.model);
  Random random(9);
  int compared = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const std::vector<float> q = random_q(r.model, random);
    const Vec2 uv{random.uniform(0.01f, 0.99f), random.uniform(0.01f, 0.99f)};
    const float h = 1e-3f;
    const SurfaceFrame f = cascade->surface_frame(uv, q.data());
    CHECK(length(f.p - cascade->surface_point(uv, q.data())) < 1e-4f);
    const Vec3 u0 = cascade->surface_point({uv.x - h, uv.y}, q.data()),
               u1 = cascade->surface_point({uv.x + h, uv.y}, q.data());
    const Vec3 v0 = cascade->surface_point({uv.x, uv.y - h}, q.data()),
               v1 = cascade->surface_point({uv.x, uv.y + h}, q.data());
    // Sample lines kink; where both one-sided differences agree there is none within h.
    if (length(u1 - 2 * f.p + u0) > 2e-3f || length(v1 - 2 * f.p + v0) > 2e-3f) continue;
    ++compared;
    CHECK(length((0.5f / h) * (u1 - u0) - f.pu) < 2.0f);
    CHECK(length((0.5f / h) * (v1 - v0) - f.pv) < 2.0f);
  }
  CHECK(compared > 60);
}

}  // namespace field_test
