// Cascade::personalise: the fixed identity of a person baked into one field, its accuracy, and what ends it.
#include <doctest/doctest.h>

#include "aligned_block.hpp"
#include "pliant/cascade.hpp"
#include "random_model.hpp"

namespace personalise_test {

using namespace pliant;

namespace {

/// A cascade with room for a personal field of side x side samples.
InArena<Cascade> with_room(const Model& model, std::uint16_t side) {
  return InArena<Cascade>(model, PersonalFieldLimits{side, side});
}

/// egg_model with an identity field behind the expressions as well, whose source an expression has touched.
ModelBuilder late_identity() {
  ModelBuilder b = egg_model(6);
  const auto q = b.parameter("late", Group::identity, -1, 1, 1);
  b.record(Operation::add_vector, {b.last()}, {q}, b.cascade[1].field);
  return b;
}

float worst_difference(Cascade& personal, Cascade& exact, const std::vector<float>& q, Random& random,
                       int points) {
  float worst = 0;
  for (int k = 0; k < points; ++k) {
    const Vec2 uv{random.uniform(0, 1), random.uniform(0, 1)};
    worst = max(worst, length(personal.surface_point(uv, q.data()) - exact.surface_point(uv, q.data())));
  }
  return worst;
}

}  // namespace

TEST_CASE("a personalised cascade takes two samples and the expressions', and gives the same surface") {
  const OpenModel m(egg_model(6));
  InArena<Cascade> personal = with_room(m.model, 65), exact(m.model);  // twice as fine as its fields
  Random random(31);
  personal->set_free(Group::expression);
  CHECK(personal->sample_count() == 11);  // the rest shape, six of identity, four of expression
  std::vector<float> q = random_q(m.model, random);
  REQUIRE(personal->personalise(q.data()) == Status::ok);
  CHECK(personal->is_personalised());
  CHECK(personal->sample_count() == 6);
  CHECK(personal->samples_per_point() == 5);
  CHECK(worst_difference(personal.object, exact.object, q, random, 2000) < 2e-3f);

  SUBCASE("identity parameters are no longer read") {
    std::vector<float> other = q;
    for (std::size_t k = 0; k < 6; ++k) other[k] = 0;
    for (std::size_t k = 6; k < q.size(); ++k) q[k] = other[k] = 0.3f * m.model.parameters()[k].maximum;
    CHECK(worst_difference(personal.object, exact.object, q, random, 500) < 2e-3f);
    CHECK(length(personal->surface_point({0.4f, 0.6f}, other.data()) -
                 personal->surface_point({0.4f, 0.6f}, q.data())) == 0);
  }
  SUBCASE("sampled surface points, selected points, frames and Jacobians agree with it") {
    exact->set_free(Group::expression);
    for (int trial = 0; trial < 200; ++trial) {
      const Vec2 uv{random.uniform(0, 1), random.uniform(0, 1)};
      std::vector<Vec3> a(personal->samples_per_point()), b(exact->samples_per_point());
      personal->sample_point(uv, q.data(), a.data());
      exact->sample_point(uv, q.data(), b.data());
      Jacobian ja, jb;
      const Vec3 p = personal->evaluate(a.data(), q.data(), &ja);
      CHECK(length(p - personal->surface_point(uv, q.data())) < 1e-4f);
      CHECK(length(p - personal->surface_frame(uv, q.data()).p) < 1e-4f);
      CHECK(length(p - exact->evaluate(b.data(), q.data(), &jb)) < 2e-3f);
      REQUIRE(ja.count == jb.count);
      for (std::size_t k = 0; k < ja.count; ++k) {
        CHECK(ja.list[k] == jb.list[k]);
        CHECK(length(ja.column[ja.list[k]] - jb.column[jb.list[k]]) < 0.05f);
      }
      const SurfaceFrame f = personal->surface_frame(uv, q.data()), g = exact->surface_frame(uv, q.data());
      CHECK(length(f.pu - g.pu) < 0.5f);  // of some 150 mm a unit
      CHECK(length(f.pv - g.pv) < 0.5f);
    }
  }
  SUBCASE("choosing the free parameters ends it, and so does forget_person") {
    personal->set_free(Group::expression);
    CHECK_FALSE(personal->is_personalised());
    REQUIRE(personal->personalise(q.data()) == Status::ok);
    personal->forget_person();
    CHECK_FALSE(personal->is_personalised());
    CHECK(personal->sample_count() == 11);
    CHECK(worst_difference(personal.object, exact.object, q, random, 500) == 0);
  }
}

TEST_CASE(
    "at its own samples a personal field is exact to its quantisation, for any composition and any choice") {
  Random random(32);
  int personal_count = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const OpenModel m(RandomModel(random).run());
    InArena<Cascade> personal = with_room(m.model, 9), exact(m.model);
    std::vector<std::uint8_t> is_free(m.model.parameters().count);
    for (auto& f : is_free) f = static_cast<std::uint8_t>(random.below(4) == 0);
    personal->set_free(is_free.data());
    exact->set_free(is_free.data());
    std::vector<float> q = random_q(m.model, random);
    REQUIRE(personal->personalise(q.data()) == Status::ok);
    if (!personal->is_personalised()) continue;
    ++personal_count;
    CHECK(personal->sample_count() < exact->sample_count());
    CHECK(personal->samples_per_point() == exact->samples_per_point());
    for (std::size_t k = 0; k < q.size(); ++k)
      if (is_free[k]) q[k] = random.uniform(-1, 1);
    float most = 1;  // of what the field holds, and so of its quantisation
    for (int k = 0; k < 81; ++k) {
      const Vec2 uv{static_cast<float>(k % 9) / 8, static_cast<float>(k / 9) / 8};
      const Vec3 p = exact->surface_point(uv, q.data());
      most = max(most, length(p));
      CHECK(length(personal->surface_point(uv, q.data()) - p) < 1e-3f * most);
      CHECK(length(personal->surface_frame(uv, q.data()).p - p) < 1e-3f * most);
      std::vector<Vec3> samples(personal->samples_per_point());
      personal->sample_point(uv, q.data(), samples.data());
      CHECK(length(personal->evaluate(samples.data(), q.data()) - p) < 1e-3f * most);
    }
  }
  CHECK(personal_count > 50);
}

TEST_CASE("an identity field behind an expression stays what it is: it is read from its own field") {
  const OpenModel m(late_identity());
  InArena<Cascade> personal = with_room(m.model, 65), exact(m.model);  // twice as fine as its fields
  personal->set_free(Group::expression);
  Random random(33);
  const std::vector<float> q = random_q(m.model, random);
  REQUIRE(personal->personalise(q.data()) == Status::ok);
  CHECK(personal->sample_count() == 7);
  CHECK(worst_difference(personal.object, exact.object, q, random, 1000) < 2e-3f);
}

TEST_CASE("more samples a side make a truer neutral, and cost six bytes each") {
  const OpenModel m(egg_model(9));
  Random random(34);
  std::vector<float> q = random_q(m.model, random);
  float last = 1e9f;
  for (std::uint16_t side = 8; side <= 64; side = static_cast<std::uint16_t>(2 * side)) {
    InArena<Cascade> personal = with_room(m.model, side), exact(m.model);
    CHECK(measured_bytes<Cascade>(m.model, PersonalFieldLimits{side, side}) ==
          measured_bytes<Cascade>(m.model) + 6u * side * side);
    personal->set_free(Group::expression);
    REQUIRE(personal->personalise(q.data()) == Status::ok);
    const float off = worst_difference(personal.object, exact.object, q, random, 2000);
    CHECK(off < 0.6f * last);
    last = off;
  }
}

TEST_CASE("on the grid of its table a personalised surface is the same to the rounding of the samples") {
  const OpenModel m(egg_model(6));
  const Field& identity = m.model.fields()[1];
  InArena<Cascade> personal(m.model, PersonalFieldLimits{identity.width, identity.height}),
      beside(m.model, PersonalFieldLimits{identity.width, 40}), exact(m.model);
  Random random(37);
  for (int person = 0; person < 5; ++person) {
    const std::vector<float> q = random_q(m.model, random);
    for (Cascade* cascade : {&personal.object, &beside.object}) {
      cascade->set_free(Group::expression);
      REQUIRE(cascade->personalise(q.data()) == Status::ok);
    }
    const float off = worst_difference(personal.object, exact.object, q, random, 2000);
    CHECK(off < 1e-3f);
    CHECK(worst_difference(beside.object, exact.object, q, random, 2000) > 10 * off);
  }
}

TEST_CASE("personalising twice bakes the second person anew") {
  const OpenModel m(egg_model(6));
  InArena<Cascade> once = with_room(m.model, 32), twice = with_room(m.model, 32);
  Random random(35);
  const std::vector<float> first = random_q(m.model, random), second = random_q(m.model, random);
  once->set_free(Group::expression);
  twice->set_free(Group::expression);
  REQUIRE(once->personalise(second.data()) == Status::ok);
  REQUIRE(twice->personalise(first.data()) == Status::ok);
  REQUIRE(twice->personalise(second.data()) == Status::ok);
  CHECK(worst_difference(once.object, twice.object, second, random, 200) == 0);
}

TEST_CASE("a person that cannot be baked is refused by name and changes nothing") {
  const OpenModel m(egg_model(3));
  InArena<Cascade> none(m.model), personal = with_room(m.model, 16), exact(m.model);
  Random random(36);
  std::vector<float> q = random_q(m.model, random);
  none->set_free(Group::expression);
  CHECK(none->personalise(q.data()) == Status::capacity);
  for (const PersonalFieldLimits odd :
       {PersonalFieldLimits{1, 16}, PersonalFieldLimits{16, 0}, PersonalFieldLimits{300, 300}}) {
    InArena<Cascade> cascade(m.model, odd);
    CHECK(cascade->personalise(q.data()) == Status::capacity);
  }
  personal->set_free(Group::expression);
  CHECK(personal->personalise(nullptr) == Status::bad_argument);
  for (const float bad : {0.0f / (q[0] - q[0]), 1e30f}) {
    std::vector<float> broken = q;
    broken[1] = bad;
    REQUIRE(personal->personalise(q.data()) == Status::ok);
    CHECK(personal->personalise(broken.data()) == Status::bad_argument);
    CHECK(personal->is_personalised());  // as before
    CHECK(worst_difference(personal.object, exact.object, q, random, 100) < 0.2f);
  }
  SUBCASE("with everything free there is nothing to personalise") {
    personal->set_all_free();
    CHECK(personal->personalise(q.data()) == Status::ok);
    CHECK_FALSE(personal->is_personalised());
  }
  SUBCASE("with everything frozen the whole surface is the neutral") {
    const std::vector<std::uint8_t> nothing(q.size(), 0);
    personal->set_free(nothing.data());
    CHECK(personal->personalise(q.data()) == Status::ok);
    CHECK(personal->sample_count() == 2);
    CHECK(personal->samples_per_point() == 1);
  }
  SUBCASE("a smaller arena is refused, and the next size fits") {
    const std::size_t bytes = measured_bytes<Cascade>(m.model, PersonalFieldLimits{16, 16});
    AlignedBlock block(bytes);
    Cascade cascade;
    Arena small(block.data(), bytes - 16), enough(block.data(), bytes);
    CHECK(create_in(small, cascade, m.model, PersonalFieldLimits{16, 16}) == Status::out_of_memory);
    CHECK(create_in(enough, cascade, m.model, PersonalFieldLimits{16, 16}) == Status::ok);
  }
}

TEST_CASE(
    "fields whose samples are the personal field's are added sample by sample, also of a part of the chart, "
    "of another size, with 8 bits and with an offset") {
  ModelBuilder b;
  b.record(Operation::constant, {}, {}, b.field(3, 9, 9, [](float u, float v) {
    return Vec3{100 * u, -100 * v, 30 * u * v};
  }));
  const auto add = [&b](const char* name, std::uint16_t field) {
    b.record(Operation::add_vector, {b.last()}, {b.parameter(name, Group::identity, -3, 3, 1)}, field);
  };
  add("whole", b.field(3, 9, 9, [](float u, float v) { return Vec3{u * u, v, 5 * u * v}; }));
  for (int c = 0; c < 3; ++c) b.fields.back().offset[c] = 0.5f * static_cast<float>(c * c) - 1;
  add("part", b.field(
                  3, 4, 3,
                  [](float u, float v) {
                    const float bump =
                        100 * (u - 0.25f) * (0.625f - u) * (v - 0.5f) * (0.75f - v);  // zero at its rim
                    return Vec3{bump, -2 * bump, 5 * bump};
                  },
                  0.25f, 0.5f, 0.625f, 0.75f));
  add("coarse", b.field(3, 5, 5, [](float u, float v) { return Vec3{v, u, 3 * u}; }));
  add("rough", b.field(
                   3, 9, 9,
                   [](float u, float v) {
                     return Vec3{u * v, u * u, v};
                   },
                   0, 0, 1, 1, false, 8));
  b.record(Operation::add_vector, {b.last()}, {b.parameter("smile", Group::expression, 0, 1, 1)},
           b.cascade[1].field);
  b.grid_mesh(2);
  b.landmark("p", 0.5f, 0.5f);
  const OpenModel m(b);
  InArena<Cascade> personal = with_room(m.model, 9), exact(m.model);
  Random random(5);
  personal->set_free(Group::expression);
  const std::vector<float> q = {1.5f, -2, 0.7f, -1.2f, 0.3f};
  REQUIRE(personal->personalise(q.data()) == Status::ok);
  REQUIRE(personal->is_personalised());
  CHECK(worst_difference(personal.object, exact.object, q, random, 2000) < 2e-3f);
}

}  // namespace personalise_test
