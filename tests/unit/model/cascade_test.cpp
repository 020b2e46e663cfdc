// Every operation of the cascade, composed at random, against the definitions in double precision.
#include <doctest/doctest.h>

#include "field_reference.hpp"
#include "random_model.hpp"

namespace cascade_test {

using namespace pliant;

namespace {

std::vector<double> doubled(const std::vector<float>& q) {
  return {q.begin(), q.end()};
}

/// The Jacobian's columns by parameter; zero where none is listed.
std::vector<Vec3> columns(const Cascade& cascade, const Jacobian& jacobian) {
  std::vector<Vec3> result(cascade.parameter_count());
  for (std::size_t k = 0; k < jacobian.count; ++k) {
    if (k > 0) CHECK(jacobian.list[k] > jacobian.list[k - 1]);
    result[cascade.parameter_of(jacobian.list[k])] = jacobian.column[jacobian.list[k]];
  }
  return result;
}

/// Position, and Jacobian of the free parameters, of one point of one model against the reference.
void compare(const Model& model, Cascade& cascade, Vec2 uv, const std::vector<float>& q, Interpolation how) {
  const double u = static_cast<double>(uv.x), v = static_cast<double>(uv.y);
  double scale = 1;
  std::vector<double> exact_q = doubled(q);
  const reference::Vec exact = reference::surface_point(model, u, v, exact_q, how, &scale);
  std::vector<Vec3> samples(cascade.samples_per_point());
  cascade.sample_point(uv, q.data(), samples.data());
  Jacobian jacobian;
  const Vec3 p = cascade.evaluate(samples.data(), q.data(), &jacobian);
  CHECK((reference::of(p) - exact).norm() < 1e-5 * scale);
  CHECK((reference::of(cascade.evaluate(samples.data(), q.data())) - exact).norm() < 1e-5 * scale);
  CHECK((reference::of(cascade.surface_point(uv, q.data())) - exact).norm() < 1e-5 * scale);
  const std::vector<Vec3> column = columns(cascade, jacobian);
  for (std::size_t k = 0; k < q.size(); ++k) {
    const double at = exact_q[k], h = 1e-5;
    exact_q[k] = at + h;
    const reference::Vec ahead = reference::surface_point(model, u, v, exact_q, how);
    exact_q[k] = at - h;
    const reference::Vec behind = reference::surface_point(model, u, v, exact_q, how);
    exact_q[k] = at;
    const bool is_free = cascade.column_of(k) != kNone;
    const reference::Vec wanted =
        is_free ? reference::Vec((ahead - behind) / (2 * h)) : reference::Vec::Zero();
    CHECK((reference::of(column[k]) - wanted).norm() < 3e-5 * scale + 1e-5 * wanted.norm());
  }
}

}  // namespace

TEST_CASE("any operations composed in any order: position and Jacobian are those of the definitions") {
  Random random(21);
  int used[9] = {}, branches = 0;
  for (int trial = 0; trial < 250; ++trial) {
    const OpenModel m(RandomModel(random).run());
    for (std::size_t i = 0; i < m.model.cascade().count; ++i) {
      const CascadeRecord& r = m.model.cascade()[i];
      ++used[static_cast<int>(r.operation)];
      branches += r.source[0] != kNone && r.source[0] + 1u != i;
    }
    InArena<Cascade> cascade(m.model);
    std::vector<std::uint8_t> is_free(m.model.parameters().count, 1);
    for (int choice = 0; choice < 3; ++choice) {
      const Interpolation how = choice == 1 ? Interpolation::bicubic : Interpolation::bilinear;
      cascade->set_interpolation(how);
      cascade->set_free(is_free.data());
      std::vector<float> q = random_q(m.model, random);
      if (choice == 2) q[0] = 0;  // a parameter at rest takes short cuts
      compare(m.model, cascade.object, {random.uniform(0, 1), random.uniform(0, 1)}, q, how);
      for (auto& f : is_free) f = static_cast<std::uint8_t>(random.below(2));
    }
  }
  for (const int count : used) CHECK(count > 100);
  CHECK(branches > 300);
}

TEST_CASE("tangents are the derivatives along u and v of any composition") {
  Random random(22);
  int compared = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const OpenModel m(RandomModel(random).run());
    InArena<Cascade> cascade(m.model);
    for (const Interpolation how : {Interpolation::bilinear, Interpolation::bicubic}) {
      cascade->set_interpolation(how);
      const std::vector<float> q = random_q(m.model, random);
      const std::vector<double> exact_q = doubled(q);
      const Vec2 uv{random.uniform(0.01f, 0.99f), random.uniform(0.01f, 0.99f)};
      double scale = 1;
      const auto at = [&](double du, double dv) {
        return reference::surface_point(m.model, static_cast<double>(uv.x) + du,
                                        static_cast<double>(uv.y) + dv, exact_q, how, &scale);
      };
      const double h = 1e-6;
      const reference::Vec p = at(0, 0), up = at(h, 0), um = at(-h, 0), vp = at(0, h), vm = at(0, -h);
      // A bilinear field kinks at its sample lines; where both sides agree there is none within h.
      if ((up - 2 * p + um).norm() > 1e-7 * scale || (vp - 2 * p + vm).norm() > 1e-7 * scale) continue;
      ++compared;
      const SurfaceFrame frame = cascade->surface_frame(uv, q.data());
      CHECK((reference::of(frame.p) - p).norm() < 1e-5 * scale);
      CHECK((reference::of(frame.pu) - (up - um) / (2 * h)).norm() < 3e-4 * scale);
      CHECK((reference::of(frame.pv) - (vp - vm) / (2 * h)).norm() < 3e-4 * scale);
    }
  }
  CHECK(compared > 350);
}

TEST_CASE("many branches may be alive at once: each keeps its own derivatives until it is joined") {
  constexpr int kBranches = 20;
  ModelBuilder b;
  const auto flat = [](float u, float v) { return Vec3{100 * u, 100 * v, 0}; };
  const auto lift = b.field(3, 5, 5, [](float u, float v) { return Vec3{u, -v, 10 + u * v}; });
  b.record(Operation::constant, {}, {}, b.field(3, 5, 5, flat));
  for (int k = 0; k < kBranches; ++k) {
    const auto q = b.parameter("q" + std::to_string(k), Group::expression, -1, 1, 1);
    CascadeRecord& turn = b.record(Operation::rotate, {0}, {q});
    turn.axis[static_cast<std::size_t>(k % 3)] = 1;
    b.record(Operation::add_vector, {b.last()}, {q}, lift);
  }
  const auto blend = b.parameter("blend", Group::expression, 0, 1, 1);
  std::uint16_t joined = 2;
  for (int k = 1; k < kBranches; ++k) {
    b.record(Operation::lerp, {joined, static_cast<std::uint16_t>(2 * k + 2)}, {blend});
    joined = b.last();
  }
  b.grid_mesh(2);
  const OpenModel m(b);
  InArena<Cascade> cascade(m.model);
  Random random(23);
  for (int trial = 0; trial < 20; ++trial)
    compare(m.model, cascade.object, {random.uniform(0, 1), random.uniform(0, 1)}, random_q(m.model, random),
            Interpolation::bilinear);
}

TEST_CASE("records that the result does not read cost nothing") {
  ModelBuilder b = egg_model(2);
  const auto q = b.parameter("unread", Group::expression, -1, 1, 1);
  const std::uint16_t end = b.last();
  const OpenModel without(b);
  b.record(Operation::add_vector, {end}, {q}, b.cascade[1].field);  // nobody reads this one
  b.record(Operation::add_vector, {end}, {q}, b.cascade[1].field);
  const OpenModel with(b);
  InArena<Cascade> a(without.model), c(with.model);
  CHECK(c->samples_per_point() == a->samples_per_point() + 1);
  CHECK(c->sample_count() == a->sample_count() + 1);
  Random random(24);
  compare(with.model, c.object, {0.3f, 0.7f}, random_q(with.model, random), Interpolation::bilinear);
}

}  // namespace cascade_test
