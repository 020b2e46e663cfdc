// Which records of a cascade are visited, and how, under a choice of free parameters.
#include "model/cascade_plan.hpp"

#include <doctest/doctest.h>

#include "model_builder.hpp"

namespace cascade_plan_test {

using namespace pliant;

namespace {

using Role = CascadePlan::Role;

/// A constant, two identity and two expression vectors in a chain, and a record that nothing reads.
struct Chain {
  std::vector<CascadeRecord> records;
  Chain() {
    ModelBuilder b;
    b.record(Operation::constant, {}, {}, 0);
    for (std::uint16_t p = 0; p < 4; ++p) b.record(Operation::add_vector, {b.last()}, {p}, 0);
    records = b.cascade;
  }
  Span<const CascadeRecord> all() const { return {records.data(), records.size()}; }
};

struct Planned {
  alignas(Arena::kAlignment) unsigned char block[4096];
  CascadePlan plan;
  Planned(Span<const CascadeRecord> records, std::vector<std::uint16_t> column_of,
          std::uint16_t personal = kNone) {
    Arena arena(block, sizeof block);
    plan.lay_out(arena, records);
    REQUIRE_FALSE(arena.exhausted());
    plan.make(records, column_of.data(), personal);
  }
};

}  // namespace

TEST_CASE("with identity frozen the last frozen record is cached, and what follows is live") {
  const Chain chain;
  const Planned p(chain.all(), {kNone, kNone, 0, 1});
  const Role expected[] = {Role::frozen, Role::frozen, Role::cached, Role::live, Role::live};
  for (std::size_t i = 0; i < 5; ++i) CHECK(p.plan.role(i) == expected[i]);
  CHECK(p.plan.needed().count == 5);
  REQUIRE(p.plan.sampled_count() == 3);
  for (std::size_t n = 0; n < 3; ++n) CHECK(p.plan.sampled(n) == n + 2);
  CHECK(p.plan.register_count() == 1);
}

TEST_CASE(
    "a chain of vectors is evaluated in place: its inner records may be skipped, its last one is stored") {
  const Chain chain;
  const Planned p(chain.all(), {0, 1, 2, 3});
  REQUIRE(p.plan.sampled_count() == 5);
  CHECK((p.plan.link(1) & CascadePlan::kFollows) != 0);
  CHECK((p.plan.link(1) & CascadePlan::kAddsHere) == 0);  // its source is cached: it has no register
  for (std::size_t n = 2; n < 5; ++n) CHECK((p.plan.link(n) & CascadePlan::kAddsHere) != 0);
  CHECK((p.plan.link(3) & CascadePlan::kMaySkip) != 0);
  CHECK((p.plan.link(4) & CascadePlan::kMaySkip) == 0);
  CHECK((p.plan.link(4) & CascadePlan::kStores) != 0);
}

TEST_CASE("everything frozen is one cached value") {
  const Chain chain;
  const Planned p(chain.all(), {kNone, kNone, kNone, kNone});
  CHECK(p.plan.sampled_count() == 1);
  CHECK(p.plan.role(4) == Role::cached);
}

TEST_CASE("records that only the personal record reads are not needed") {
  const Chain chain;
  const Planned p(chain.all(), {kNone, kNone, 0, 1}, 2);
  CHECK(p.plan.personal_record() == 2);
  REQUIRE(p.plan.needed().count == 3);
  CHECK(p.plan.needed()[0] == 2);
  CHECK(p.plan.role(0) == Role::unused);
}

TEST_CASE("two branches that are joined need a register each") {
  ModelBuilder b;
  b.record(Operation::constant, {}, {}, 0);
  b.record(Operation::add_vector, {0}, {0}, 0);
  b.record(Operation::add_vector, {0}, {1}, 0);
  b.record(Operation::lerp, {1, 2}, {2});
  const Planned p({b.cascade.data(), b.cascade.size()}, {0, 1, 2});
  CHECK(p.plan.register_count() >= 2);
  CHECK(p.plan.register_of(1) != p.plan.register_of(2));
  CHECK((p.plan.link(1) & CascadePlan::kStores) != 0);
}

}  // namespace cascade_plan_test
