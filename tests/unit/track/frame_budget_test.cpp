// The budget of a frame: what rare work is granted, what waits, and what is reserved.
#include "track/frame_budget.hpp"

#include <doctest/doctest.h>

namespace frame_budget_test {

using namespace pliant;

namespace {

/// 100 steps of searches, of which `steps` have been taken.
FrameBudget budget_with(std::uint32_t steps) {
  FrameBudget budget;
  budget.costs.search_step = 10;
  budget.most = 1000;
  budget.begin(true);
  budget.work.search_steps = steps;
  return budget;
}

}  // namespace

TEST_CASE("rare work is granted what searches and solves have left, and leaves less itself") {
  FrameBudget budget = budget_with(40);
  CHECK(budget.left() == 600);
  CHECK_FALSE(budget.take_now(budget.person, 601));
  CHECK(budget.left() == 600);
  CHECK(budget.take_now(budget.person, 400));
  CHECK(budget.left() == 200);
  CHECK_FALSE(budget.take_now(budget.person, 400));
  CHECK(budget.work.rare == 400);
}

TEST_CASE("searches leave a part of the budget to the solves, and more where rare work is reserved") {
  FrameBudget budget = budget_with(0);
  CHECK(budget.left_for_searches() == doctest::Approx(1000 * double(kFrameBudgetTuning.most_of_searches)));
  budget.reserved = 500;
  CHECK(budget.left_for_searches() ==
        doctest::Approx(500 * double(kFrameBudgetTuning.most_of_searches_if_reserved)));
  budget.reserved = 0;
  budget.costs.coarse_pixel = 1;
  budget.work.coarse_pixels = 1200;  // more than there is
  CHECK(budget.left_for_searches() == 0);
}

TEST_CASE("work that waits is reserved after some frames, which lowers what is left for all else") {
  FrameBudget budget = budget_with(90);
  for (int n = 0; n < kFrameBudgetTuning.most_waited; ++n) {
    budget.begin(true);
    CHECK(budget.left() == 1000);
    budget.work.search_steps = 90;
    CHECK_FALSE(budget.take(budget.check, 300));
  }
  budget.begin(false);  // this frame may need all
  CHECK(budget.left() == 1000);
  budget.work.search_steps = 90;
  CHECK_FALSE(budget.take(budget.check, 300));
  budget.begin(true);
  CHECK(budget.left() == 700);
  budget.work.search_steps = 70;
  CHECK_FALSE(budget.take_now(budget.check, 1));
  CHECK(budget.take(budget.check, 300));
  CHECK(budget.left() == 0);
  budget.begin(true);
  CHECK(budget.left() == 1000);
}

TEST_CASE("for work that does less once it is overdue, no more than that is reserved") {
  FrameBudget budget = budget_with(90);
  for (int n = 0; n < kFrameBudgetTuning.most_waited; ++n) {
    budget.begin(true);
    budget.work.search_steps = 90;
    CHECK_FALSE(budget.take(budget.key_frame, 400, 300));
  }
  budget.begin(true);
  REQUIRE(budget.key_frame.is_reserved);
  CHECK(budget.left() == 700);
  CHECK(budget.take(budget.key_frame, 300, 300));
  CHECK(budget.work.rare == 300);
}

TEST_CASE("a frame does rare work of one kind; what it refuses waits, and is served at last") {
  FrameBudget budget = budget_with(0);
  for (int n = 0; n < kFrameBudgetTuning.most_waited; ++n) {
    budget.begin(true);
    CHECK(budget.take_now(budget.person, 100));
    CHECK(budget.take_now(budget.person, 100));
    CHECK(budget.left_for(budget.check) == 0);
    CHECK_FALSE(budget.take(budget.check, 300));
  }
  budget.begin(true);  // now the person's work waits, although there is room for both
  CHECK(budget.left_for(budget.person) == 0);
  CHECK_FALSE(budget.take_now(budget.person, 100));
  CHECK_FALSE(budget.take(budget.person, 100));
  CHECK(budget.take(budget.check, 300));
  CHECK_FALSE(budget.take(budget.key_frame, 100));
  budget.begin(true);
  CHECK(budget.take(budget.key_frame, 100));
}

TEST_CASE("where nothing is reserved, overdue work comes first all the same") {
  FrameBudget budget = budget_with(0);
  budget.check.hurry(300);
  budget.begin(false);
  CHECK(budget.left() == 1000);
  CHECK_FALSE(budget.take_now(budget.person, 100));
  CHECK(budget.take(budget.check, 300));
}

TEST_CASE("what is reserved for a kind of work does not keep its smaller parts from being done") {
  FrameBudget budget = budget_with(0);
  budget.person.hurry(400);
  budget.begin(true);
  CHECK(budget.left_for(budget.person) == 600);
  CHECK(budget.take_now(budget.person, 500));
  CHECK(budget.take(budget.person, 400));
}

TEST_CASE("one work is reserved at a time, and at most a fraction of the budget") {
  FrameBudget budget = budget_with(0);
  budget.check.hurry(300);
  budget.key_frame.hurry(800);
  budget.begin(true);
  CHECK(budget.left() == 700);
  CHECK_FALSE(budget.key_frame.is_reserved);
  CHECK(budget.take(budget.check, 300));
  budget.begin(true);
  CHECK(budget.left() == doctest::Approx(static_cast<double>(1000 - budget.most_reserved())));
  CHECK(budget.take(budget.key_frame, 800));
}

TEST_CASE("what a frame has reserved and not used is free in the next one") {
  FrameBudget budget = budget_with(0);
  budget.check.hurry(300);
  budget.begin(true);
  REQUIRE(budget.left() == 700);
  SUBCASE("which may need all") {
    budget.begin(false);
  }
  SUBCASE("of another track") {
    budget.forget_waiting();
    budget.begin(true);
    CHECK(budget.take_now(budget.person, 100));  // and no kind comes first
  }
  CHECK(budget.left() + budget.work.rare == 1000);
}

TEST_CASE("each kind of work that can wait is reserved for once it is overdue, checks first, looks last") {
  FrameBudget budget = budget_with(0);
  WaitingWork* const kinds[] = {&budget.check, &budget.key_frame, &budget.person, &budget.second_look};
  for (WaitingWork* kind : kinds) kind->hurry(300);
  for (WaitingWork* kind : kinds) {
    budget.begin(true);
    CHECK(budget.left() == 700);
    for (WaitingWork* other : kinds) CHECK(other->is_reserved == (other == kind));
    CHECK(budget.take(*kind, 300));
  }
}

TEST_CASE("all that is left is granted, in a frame for one kind of work") {
  FrameBudget budget = budget_with(40);
  CHECK(budget.take_now(budget.person, 600));
  CHECK(budget.left() == 0);
  budget.begin(true);
  CHECK(budget.take(budget.check, 1000));
  budget.begin(true);
  CHECK(budget.take(budget.check, 100));
  CHECK_FALSE(budget.take(budget.key_frame, 100));
}

TEST_CASE("rare work that a frame begins with takes half of the budget, and what was reserved waits") {
  FrameBudget budget = budget_with(0);
  budget.check.hurry(300);
  budget.begin(true);
  budget.give_half_to(budget.person);
  CHECK(budget.left() == 500);
  CHECK_FALSE(budget.take(budget.check, 300));
  CHECK(budget.take_now(budget.person, 500));
  budget.begin(true);
  CHECK(budget.take(budget.check, 300));
  budget.begin(true);
  budget.give_half_to(budget.person);  // nothing was reserved
  CHECK_FALSE(budget.take_now(budget.check, 100));
  CHECK(budget.left() == 500);
}

TEST_CASE("the work of a frame is that of all its loops") {
  const WorkCosts costs = WorkCosts::of(11, 44, 40);
  FrameWork work;
  work.search_steps = 3;
  work.rows = 5;
  work.measured_rows = 7;
  work.factorisations = 2;
  work.forces = 11;
  work.coarse_pixels = 100;
  work.rare = 1000;
  const float solves = 5 * costs.row + 7 * costs.measured_row + 2 * costs.factorisation + 11 * costs.force;
  CHECK(costs.of_solves(work) == doctest::Approx(static_cast<double>(solves)));
  CHECK(costs.of(work) == doctest::Approx(static_cast<double>(solves + 3 * costs.search_step +
                                                              100 * costs.coarse_pixel + 1000)));
}

}  // namespace frame_budget_test
