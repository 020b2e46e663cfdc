// The chain rule on the Jacobians of values that are alive at once (Eq. 11).
#include "model/jacobian_registers.hpp"

#include <doctest/doctest.h>

#include "model_builder.hpp"

namespace jacobian_registers_test {

using namespace pliant;

namespace {

/// A lerp of two branches, one free parameter each, and its own parameter.
struct Branches {
  ModelBuilder b;
  std::vector<std::uint16_t> columns{0, 1, 2};
  alignas(Arena::kAlignment) unsigned char block[4096];
  CascadePlan plan;
  JacobianRegisters registers;
  Branches() {
    b.record(Operation::constant, {}, {}, 0);
    b.record(Operation::add_vector, {0}, {0}, 0);
    b.record(Operation::add_vector, {0}, {1}, 0);
    b.record(Operation::lerp, {1, 2}, {2});
    Arena arena(block, sizeof block);
    plan.lay_out(arena, records());
    registers.lay_out(arena, plan.register_count(), columns.size());
    REQUIRE_FALSE(arena.exhausted());
    plan.make(records(), columns.data(), kNone);
    registers.set_columns(columns.data());
  }
  Span<const CascadeRecord> records() const { return {b.cascade.data(), b.cascade.size()}; }
};

}  // namespace

TEST_CASE("a join scales the columns of both sources, adds its own, and lists them in order") {
  Branches t;
  t.registers.clear();
  FieldStep step;
  step.along_parameter[0] = {1, 2, 3};
  t.registers.propagate(t.plan, t.b.cascade[1], 1, step);
  step.along_parameter[0] = {4, 5, 6};
  t.registers.propagate(t.plan, t.b.cascade[2], 2, step);
  FieldStep join;
  join.keep = 0.75f;
  join.keep_second = 0.25f;
  join.along_parameter[0] = {7, 8, 9};
  t.registers.propagate(t.plan, t.b.cascade[3], 3, join);
  const Jacobian j = t.registers.sorted(t.plan.register_of(3));
  REQUIRE(j.count == 3);
  for (std::uint16_t k = 0; k < 3; ++k) CHECK(j.list[k] == k);
  CHECK(length(j.column[0] - Vec3{0.75f, 1.5f, 2.25f}) == 0);
  CHECK(length(j.column[1] - Vec3{1, 1.25f, 1.5f}) == 0);
  CHECK(length(j.column[2] - Vec3{7, 8, 9}) == 0);
}

TEST_CASE("a second derivative along one parameter is added to the first; clear empties all") {
  Branches t;
  t.registers.clear();
  t.registers.add(t.registers[0], 1, {1, 0, 0});
  t.registers.add(t.registers[0], 1, {0, 2, 0});
  Jacobian j = t.registers.sorted(0);
  REQUIRE(j.count == 1);
  CHECK(length(j.column[1] - Vec3{1, 2, 0}) == 0);
  t.registers.clear();
  t.registers.add(t.registers[0], 1, {5, 0, 0});
  j = t.registers.sorted(0);
  CHECK(length(j.column[1] - Vec3{5, 0, 0}) == 0);
}

TEST_CASE("a frozen parameter has no column") {
  Branches t;
  t.columns[0] = kNone;
  t.registers.clear();
  t.registers.add(t.registers[0], 0, {1, 0, 0});
  CHECK(t.registers.sorted(0).count == 0);
}

}  // namespace jacobian_registers_test
