// A personal field: what it holds, what it refuses, and its gradient.
#include "model/personal_field.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "open_model.hpp"
#include "pliant/field.hpp"
#include "random.hpp"

namespace personal_field_test {

using namespace pliant;

namespace {

ModelBuilder flat_sheet() {
  ModelBuilder b;
  b.record(Operation::constant, {}, {}, b.field(3, 3, 3, [](float u, float v) {
    return Vec3{100 * u, -100 * v, 0};
  }));
  b.grid_mesh(2);
  b.landmark("p", 0.5f, 0.5f);
  return b;
}

/// The flat sheet, raised by a bilinear function.
Vec3 raised(Vec2 uv) {
  return {100 * uv.x, -100 * uv.y, 10 * uv.x - 4 * uv.y};
}

/// Fills the field with the differences of a surface to its root.
template <class Surface>
Status fill(PersonalField& field, const OpenModel& flat, const Surface& surface) {
  return field.fill(0, [&](std::size_t i, std::size_t j, Span<Vec3> out) {
    for (std::size_t k = 0; k < out.count; ++k) {
      const Vec2 uv = field.uv_of(i + k, j);
      out[k] = surface(uv) - sample(flat.model, flat.model.fields()[0], uv);
    }
  });
}

}  // namespace

TEST_CASE("the field holds the difference to its root to the rounding of its samples, with its gradient") {
  const OpenModel flat(flat_sheet());
  InArena<PersonalField> field(PersonalFieldLimits{9, 9});
  REQUIRE(field->has_room());
  REQUIRE(fill(field.object, flat, raised) == Status::ok);
  for (const Vec2 uv : {Vec2{0, 0}, Vec2{1, 1}, Vec2{0.3f, 0.7f}, Vec2{0.99f, 0.01f}}) {
    Vec3 du, dv;
    const Vec3 p = field->sample(flat.model, uv, Interpolation::bilinear, &du, &dv);
    CHECK(length(p - raised(uv)) < 5e-3f);
    CHECK(length(du - Vec3{100, 0, 10}) < 0.05f);
    CHECK(length(dv - Vec3{0, -100, -4}) < 0.05f);
  }
}

TEST_CASE("a surface that is not finite is refused and the field stays as it was") {
  const OpenModel flat(flat_sheet());
  InArena<PersonalField> field(PersonalFieldLimits{5, 5});
  REQUIRE(fill(field.object, flat, raised) == Status::ok);
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), 1e20f}) {
    const auto broken = [bad](Vec2 uv) { return uv.x > 0.9f ? Vec3{bad, 0, 0} : raised(uv); };
    CHECK(fill(field.object, flat, broken) == Status::bad_argument);
    CHECK(length(field->sample(flat.model, {0.5f, 0.5f}, Interpolation::bilinear, nullptr, nullptr) -
                 raised({0.5f, 0.5f})) < 5e-3f);
  }
}

TEST_CASE("a size outside 2 to 256 has no room") {
  for (const PersonalFieldLimits odd :
       {PersonalFieldLimits{0, 0}, PersonalFieldLimits{1, 9}, PersonalFieldLimits{9, 257}}) {
    InArena<PersonalField> field(odd);
    CHECK_FALSE(field->has_room());
  }
}

}  // namespace personal_field_test
