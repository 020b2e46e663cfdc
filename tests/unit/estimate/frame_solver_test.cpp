#include "estimate/frame_solver.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "posed_egg.hpp"
#include "random.hpp"

namespace frame_solver_test {

using namespace pliant;

namespace {

constexpr std::size_t kPoints = 49;

FrameSolverLimits limits_of(const PosedEgg& egg, bool rejects) {
  FrameSolverLimits limits;
  limits.points = kPoints;
  limits.parameters = egg.parameters();
  limits.unknowns = kPoseUnknowns + 4;
  limits.rejection_sample = rejects ? kPoints : 0;
  limits.rejection = rejects ? &kForceRejection : nullptr;
  return limits;
}

/// A solver on a grid of points, and a second egg that says where they are seen.
struct Rig {
  PosedEgg egg, truth;
  ExpectedEgg expected{egg};
  InArena<SurfacePoints> points{kPoints, std::size_t{0}, egg.samples()};
  InArena<FrameSolver> solver;
  Random random{3};

  explicit Rig(Rejection rejection, bool rejects = true) : solver(limits_of(egg, rejects)) {
    points->clear(egg.samples());
    std::uint16_t id;
    for (int i = 0; i < int(kPoints); ++i)
      REQUIRE(points->add(PointKind::surface, {0.14f + 0.12f * float(i % 7), 0.14f + 0.12f * float(i / 7)},
                          {}, egg.cascade.object, egg.state.q, &id) == Status::ok);
    solver->start({4, rejection, {0x07, 1, 0.1f}});
    solver->begin();
  }
  void move_truth(float turn) { truth.pose({exp_rotation({0, turn, 0}), {3, 5, 700}}); }
  std::vector<Observation> observe(float noise = 0.1f) {
    std::vector<Observation> out;
    for (std::uint16_t id = 0; id < kPoints; ++id) {
      Observation o;
      o.id = id;
      o.x = truth.image_of(points->uv(id)) + Vec2{noise * random.normal(), noise * random.normal()};
      o.information = {25, 0, 25};
      o.score = 0.9f;
      out.push_back(o);
    }
    return out;
  }
  SolverReport solve(std::vector<Observation>& o) {
    return solver->solve({egg.cascade.object, points.object, expected.motion->expected()},
                         {o.data(), o.size()}, {}, &egg.state);
  }
  bool first_pass(std::vector<Observation>& o) {
    return solver->solve_first_pass({egg.cascade.object, points.object, expected.motion->expected()},
                                    {o.data(), o.size()}, &egg.state);
  }
  /// Mean distance between the points where they are and where the state puts them, px.
  float error() {
    float sum = 0;
    for (std::uint16_t id = 0; id < kPoints; ++id)
      sum += length(egg.image_of(points->uv(id)) - truth.image_of(points->uv(id)));
    return sum / static_cast<float>(kPoints);
  }
};

}  // namespace

TEST_CASE("every rejection finds pose and expression from good observations") {
  for (const Rejection rejection : {Rejection::none, Rejection::weights, Rejection::forces,
                                    Rejection::forces_readmitted, Rejection::on_doubt}) {
    CAPTURE(static_cast<int>(rejection));
    Rig rig(rejection);
    rig.move_truth(0.03f);
    // Forces without readmission reject the jaw, which the rigid block does not explain.
    const float jaw = rejection == Rejection::forces ? 0.0f : 0.1f;
    rig.truth.q[5] = jaw;
    REQUIRE(rig.error() > 2.5f);
    auto seen = rig.observe();
    const SolverReport report = rig.solve(seen);
    CHECK(rig.error() < 0.4f);
    CHECK(rig.egg.q[5] == doctest::Approx(double(jaw)).epsilon(0.15).scale(0.1));
    CHECK(rig.egg.q[0] == 0);
    CHECK(report.final_cost < report.initial_cost);
    CHECK(rig.solver->result().rows == kPoints);
    CHECK(rig.solver->result().inliers > 35);
    CHECK(rig.solver->result().pose_is_observed);
    CHECK(rig.solver->result().score == doctest::Approx(0.9));
  }
}

TEST_CASE("a coherent occluder pulls least squares away, weights less, forces least") {
  float error[3] = {};
  const Rejection each[3] = {Rejection::none, Rejection::weights, Rejection::forces_readmitted};
  for (int k = 0; k < 3; ++k) {
    Rig rig(each[k]);
    rig.move_truth(0.02f);
    auto seen = rig.observe();
    for (std::size_t i = 0; i < seen.size(); ++i)
      if (i % 7 < 2) seen[i].x = seen[i].x + Vec2{25, 18};
    rig.solve(seen);
    error[k] = rig.error();
    int rejected = 0;
    for (const Observation& o : seen) rejected += o.reason == Reason::rejected;
    if (k == 2) CHECK(rejected >= 14);
  }
  CHECK(error[2] <= error[1]);
  CHECK(error[1] < error[0]);
  CHECK(error[2] < 0.5f);
}

TEST_CASE("a doubtful result is compared with the alternative: a jaw that drops is no occluder") {
  Rig rig(Rejection::on_doubt);
  rig.truth.q[5] = 0.3f;
  auto seen = rig.observe();
  rig.solve(seen);
  CHECK(rig.egg.q[5] == doctest::Approx(0.3).epsilon(0.1));
  CHECK(rig.solver->result().inliers > 40);
}

TEST_CASE("too few observations, or none, move nothing and give no inliers") {
  Rig rig(Rejection::on_doubt);
  rig.move_truth(0.05f);
  const float before = rig.error();
  auto seen = rig.observe();
  seen.resize(4);
  rig.solve(seen);
  std::vector<Observation> none;
  rig.solve(none);
  CHECK(rig.error() == before);
  CHECK(rig.solver->result().inliers == 0);
  CHECK_FALSE(rig.first_pass(none));
}

TEST_CASE("edges of one direction do not determine the pose") {
  Rig rig(Rejection::weights);
  auto seen = rig.observe();
  for (Observation& o : seen) o.information = {25, 0, 0};
  rig.solve(seen);
  CHECK_FALSE(rig.solver->result().pose_is_observed);
}

TEST_CASE("a first pass moves the state, or leaves it if the result is doubtful") {
  Rig rig(Rejection::on_doubt);
  rig.move_truth(0.03f);
  auto few = rig.observe();
  for (Observation& o : few)
    if (o.id % 3 != 0) o.reason = Reason::not_visible;
  auto wild = few;
  for (std::size_t i = 0; i < wild.size(); i += 6) wild[i].x = wild[i].x + Vec2{30, -25};
  const float before = rig.error();
  CHECK_FALSE(rig.first_pass(wild));
  CHECK(rig.error() == before);
  CHECK(rig.first_pass(few));
  CHECK(rig.error() < 0.3f * before);
  auto all = rig.observe();
  rig.solve(all);
  CHECK_FALSE(rig.solver->needs_another_round());
}

TEST_CASE("without a table of rejection, forces are not rejected and the memory is smaller") {
  Rig with(Rejection::forces), without(Rejection::forces, false);
  CHECK(without.solver.arena.used_bytes() < with.solver.arena.used_bytes());
  auto seen = without.observe();
  without.solve(seen);
  CHECK(without.error() < 0.3f);
}

TEST_CASE("variances follow the number of observations after a good frame") {
  float variance[2];
  for (const bool half : {false, true}) {
    Rig rig(Rejection::weights);
    auto seen = rig.observe();
    for (Observation& o : seen)
      if (half && o.id % 2 != 0) o.reason = Reason::not_visible;
    rig.solve(seen);
    CHECK(rig.solver->variance()[kShiftX] == 0);
    rig.solver->conclude_frame();
    variance[half] = rig.solver->variance()[kShiftX];
  }
  CHECK(variance[0] > 0);
  CHECK(variance[1] > 1.5f * variance[0]);
}

TEST_CASE(
    "solves end early once they have taken the work that a frame may, and their result is still an "
    "improvement") {
  Rig rig(Rejection::on_doubt), limited(Rejection::on_doubt);
  const WorkCosts costs{1, 100, 10, 1000};
  limited.solver->limit_work(costs, 100 * 3 * kPoints);  // three passes, the last one among them
  rig.move_truth(0.2f);
  limited.move_truth(0.2f);
  auto all = rig.observe(), some = limited.observe();
  rig.solve(all);
  const SolverReport report = limited.solve(some);
  CHECK(report.final_cost < report.initial_cost);
  const FrameWork work = limited.solver->work();
  CHECK(work.rows <= 3 * kPoints);
  CHECK(work.rows < rig.solver->work().rows);
  CHECK(costs.of_solves(rig.solver->work()) > 2 * costs.of_solves(work));
  // With nothing left a solve still makes the pass that the equations need.
  for (const float nothing : {1.0f, -1.0f}) {
    const std::uint32_t before = limited.solver->work().rows;
    limited.solver->limit_work(costs, nothing);
    auto more = limited.observe();
    CHECK(limited.solve(more).iterations == 0);
    CHECK(limited.solver->work().rows <= before + 2 * kPoints);
  }
}

TEST_CASE("in a later round of a frame, rows that were rejected come back where they fit, and only there") {
  Rig rig(Rejection::forces_readmitted);
  rig.move_truth(0.02f);
  auto seen = rig.observe();
  const auto occlude = [](std::vector<Observation>& o, std::size_t columns) {
    for (std::size_t i = 0; i < o.size(); ++i)
      if (i % 7 < columns) o[i].x = o[i].x + Vec2{25, 18};
  };
  occlude(seen, 2);
  rig.solve(seen);
  for (std::size_t i = 0; i < seen.size(); ++i) CHECK((seen[i].reason == Reason::rejected) == (i % 7 < 2));
  auto again = rig.observe();
  occlude(again, 1);
  rig.solve(again);
  for (std::size_t i = 0; i < again.size(); ++i) CHECK((again[i].reason == Reason::rejected) == (i % 7 < 1));
  CHECK(rig.solver->result().inliers == 42);
  CHECK(rig.error() < 0.3f);
}

TEST_CASE("whatever a frame may take, its solves take no more once they have made their last passes") {
  for (const float measured_row : {10.0f, 90.0f})
    for (int passes = 2; passes < 12; ++passes) {
      CAPTURE(measured_row);
      CAPTURE(passes);
      const WorkCosts costs{1, 100, measured_row, 1000};
      Rig rig(Rejection::on_doubt);
      const float most = 100 * kPoints * static_cast<float>(passes);
      rig.solver->limit_work(costs, most);
      rig.move_truth(0.2f);
      auto seen = rig.observe();
      rig.solve(seen);
      CHECK(costs.of_solves(rig.solver->work()) <= most);
    }
}

TEST_CASE(
    "a frame knows nothing of the one before it: its first pass and its two rounds give the same bits") {
  std::vector<float> bits[2];
  for (const bool is_second : {false, true}) {
    Rig rig(Rejection::on_doubt);
    rig.solver->start({8, Rejection::on_doubt, {0x07, 1, 0}});  // scales of the cues would stay
    const ModelState& state = rig.egg.state;
    if (is_second) {
      const View view = state.view;
      const std::vector<float> q = rig.egg.q;
      rig.random = Random(9);
      auto few = rig.observe();
      CHECK(rig.first_pass(few));
      rig.truth.q[5] = 0.4f;  // which the first pass did not see
      rig.move_truth(0.05f);
      auto seen = rig.observe();
      for (std::size_t i = 0; i < seen.size(); ++i)
        if (i % 7 < 3) seen[i].x = seen[i].x + Vec2{25, 18};
      rig.solve(seen);
      CHECK(rig.solver->needs_another_round());
      CHECK(rig.solver->work().rows > 0);
      rig.truth.q[5] = 0;
      rig.egg.state.view = view;
      std::copy(q.begin(), q.end(), rig.egg.q.begin());
      rig.random = Random(3);
      rig.solver->begin();
    }
    CHECK_FALSE(rig.solver->needs_another_round());
    CHECK(rig.solver->work().rows == 0);
    CHECK(rig.solver->work().factorisations == 0);
    CHECK(rig.solver->result().inliers == 0);
    CHECK(rig.solver->result().rows == 0);
    rig.move_truth(0.02f);
    auto seen = rig.observe();
    for (std::size_t i = 0; i < seen.size(); i += 9) seen[i].x = seen[i].x + Vec2{2, -1};
    for (int round = 0; round < 2; ++round) {
      const SolverReport report = rig.solve(seen);
      for (const float x :
           {state.view.q.w, state.view.q.y, state.view.s, state.view.tau.x, state.q[5], report.final_cost,
            static_cast<float>(rig.solver->result().inliers), static_cast<float>(rig.solver->work().rows)})
        bits[is_second].push_back(x);
    }
  }
  CHECK(bits[0] == bits[1]);
}

TEST_CASE("a new start has no limit of work from the track before") {
  Rig rig(Rejection::weights), limited(Rejection::weights);
  limited.solver->limit_work({1, 100, 10, 1000}, 1);
  limited.solver->start({4, Rejection::weights, {0x07, 1, 0.1f}});
  limited.solver->begin();
  for (Rig* each : {&rig, &limited}) {
    each->move_truth(0.05f);
    auto seen = each->observe();
    each->solve(seen);
  }
  CHECK(limited.solver->result().iterations == rig.solver->result().iterations);
  CHECK(limited.error() == rig.error());
}

TEST_CASE("the iterations of a frame are those of its first pass and of all its rounds") {
  Rig rig(Rejection::weights);
  rig.move_truth(0.03f);
  auto seen = rig.observe();
  REQUIRE(rig.first_pass(seen));
  unsigned all = rig.solver->result().iterations;
  CHECK(all > 0);
  for (int round = 0; round < 2; ++round) {
    rig.move_truth(0.03f - 0.02f * static_cast<float>(round + 1));
    seen = rig.observe();
    all += static_cast<unsigned>(rig.solve(seen).iterations);
    CHECK(rig.solver->result().iterations == all);
  }
}

TEST_CASE(
    "a first pass of edges in one direction, and one whose points all fit badly, leave the state as it was") {
  for (const bool is_line : {false, true}) {
    Rig rig(Rejection::on_doubt);
    rig.move_truth(0.01f);
    auto seen = rig.observe(is_line ? 0.1f : 3.0f);
    if (is_line)
      for (Observation& o : seen) o.information = {25, 0, 0};
    const float before = rig.error();
    CHECK_FALSE(rig.first_pass(seen));
    CHECK(rig.error() == before);
    CHECK(rig.egg.q[5] == 0);
  }
}

TEST_CASE("an observation is told its residual, and the score is the mean of those that have one") {
  Rig rig(Rejection::on_doubt);
  rig.move_truth(0.03f);
  auto seen = rig.observe();
  seen[11].x = seen[11].x + Vec2{12, 9};
  for (std::size_t i = 0; i < seen.size(); i += 2) seen[i].score = 0;
  rig.solve(seen);
  CHECK(seen[11].reason == Reason::rejected);
  for (const Observation& o : seen)  // samples leave out what moves a point by 0.01 mm, about as many px
    CHECK(length(o.residual - (o.x - rig.egg.image_of(rig.points->uv(o.id)))) < 0.05f);
  CHECK(rig.solver->result().score == doctest::Approx(0.9));
}

TEST_CASE(
    "where doubt has cause, the better one of two results counts: an occluder's as by forces, a jaw's as by "
    "weights") {
  // Half of one side moves together, or the jaw drops beside observations that are wrong each on its own.
  for (const bool is_jaw : {false, true}) {
    CAPTURE(is_jaw);
    float error[3] = {};
    std::vector<float> results[3];  // of two rounds
    const Rejection each[3] = {Rejection::weights, Rejection::forces_readmitted, Rejection::on_doubt};
    for (int k = 0; k < 3; ++k) {
      Rig rig(each[k]);
      rig.solver->start({12, each[k], {0x07, 1, 0}});
      rig.solver->begin();
      rig.move_truth(0.02f);
      rig.truth.q[5] = is_jaw ? 0.35f : 0.0f;
      auto seen = rig.observe();
      for (std::size_t i = 0; i < seen.size(); ++i) {
        if (!is_jaw && i % 7 < 3) seen[i].x = seen[i].x + Vec2{9, 7};
        if (is_jaw && i % 5 == 0)
          seen[i].x = seen[i].x + Vec2{40 * rig.random.normal(), 40 * rig.random.normal()};
      }
      for (int round = 0; round < 2; ++round) {
        const float cost = rig.solve(seen).final_cost;
        for (const float x : {rig.error(), cost, static_cast<float>(rig.solver->result().inliers)})
          results[k].push_back(x);
      }
      error[k] = rig.error();
      for (const Observation& o : seen)
        CHECK(length(o.residual - (o.x - rig.egg.image_of(rig.points->uv(o.id)))) < 0.05f);
    }
    const int better = is_jaw ? 0 : 1;
    REQUIRE(error[better] < 0.2f);  // of a noise of 0.1 px
    REQUIRE(error[1 - better] > 2);
    CHECK(results[2] == results[better]);
  }
}

}  // namespace frame_solver_test
