// The cost of a frame and its equations: observations, priors, springs.
#include "estimate/frame_problem.hpp"

#include <doctest/doctest.h>

#include "posed_egg.hpp"
#include "random.hpp"

namespace frame_problem_test {

using namespace pliant;

namespace {

constexpr std::size_t kPoints = 36, kJaw = 5;

/// Points of an egg, seen where another one has them.
struct Rig {
  PosedEgg egg, truth;
  ExpectedEgg expected{egg};
  std::size_t unknowns = kPoseUnknowns + egg.cascade->column_count();
  InArena<SurfacePoints> points{kPoints, std::size_t{0}, egg.samples()};
  InArena<ObservationRows> rows{kPoints};
  InArena<SolveScratch> scratch{egg.parameters(), unknowns};
  std::vector<Observation> seen;
  SolveInput input{egg.cascade.object, points.object, expected.motion->expected()};
  FrameProblem problem{input, rows.object, scratch.object, egg.state};

  /// \param information  of an observation, 1/px^2. \param has_lines  every second one is known across a line only.
  Rig(float turn, float jaw, float information, bool has_lines = false) {
    points->clear(egg.samples());
    std::uint16_t id;
    for (int k = 0; k < int(kPoints); ++k)
      REQUIRE(points->add(PointKind::surface, {0.2f + 0.12f * float(k % 6), 0.2f + 0.12f * float(k / 6)}, {},
                          egg.cascade.object, egg.state.q, &id) == Status::ok);
    truth.pose({exp_rotation({0, turn, 0}), {1, 5, 700}});
    truth.q[kJaw] = jaw;
    for (id = 0; id < kPoints; ++id) {
      Observation o;
      o.id = id;
      o.x = truth.image_of(points->uv(id));
      o.information = {information, 0, information};
      if (has_lines && id % 2 != 0) o.information = {information / 2, information / 2, information / 2};
      seen.push_back(o);
    }
    rows->start({0x07, 0, 0.1f});
    rows->gather({seen.data(), seen.size()}, points.object, egg.state.view.s);
  }
  const Parameter& parameter(std::size_t column) {
    return egg.model.parameters()[egg.cascade->parameter_of(column)];
  }
  /// The state moved along one unknown.
  float cost_at(std::size_t unknown, float step) {
    std::vector<float> steps(unknowns, 0.0f);
    steps[unknown] = step;
    const View view = problem.state.view;
    problem.state.view = moved(view, steps.data(), kPoseUnknowns);
    float unused = 0;
    float& q = unknown < kPoseUnknowns ? unused
                                       : problem.state.q[egg.cascade->parameter_of(unknown - kPoseUnknowns)];
    const float before = q;
    q += step;
    const float cost = problem.linearise();
    q = before;
    problem.state.view = view;
    return cost;
  }
};

}  // namespace

TEST_CASE(
    "the equations are the cost's slope in every unknown: with outliers, and where a parameter is near and "
    "far from its expected value") {
  bool has_lines = false;
  SUBCASE("points") {}
  SUBCASE("points and lines") {
    has_lines = true;
  }
  for (const Loss loss : {Loss::squares, Loss::huber, Loss::tukey})
    for (const float jaw : {0.02f, 0.25f}) {
      Rig rig(0.01f, 0.1f, 4, has_lines);
      rig.seen[3].x = rig.seen[3].x + Vec2{2, -1};
      rig.problem.loss = loss;
      rig.egg.q[kJaw] = jaw;
      const float sd = rig.expected.motion->expected().parameter_sd[kJaw];
      REQUIRE((jaw > 1.345f * sd) == (jaw > 0.1f));
      for (std::size_t k = 0; k < rig.unknowns; ++k) {
        CAPTURE(static_cast<int>(loss));
        CAPTURE(jaw);
        CAPTURE(k);
        rig.problem.linearise();
        const float slope = -rig.scratch->equations.g(k), curve = rig.scratch->equations.h(k, k);
        const float step = 0.05f / square_root(curve);
        const float measured = (rig.cost_at(k, step) - rig.cost_at(k, -step)) / (2 * step);
        CHECK(magnitude(measured - slope) < 0.02f * (magnitude(slope) + square_root(curve)));
      }
    }
}

TEST_CASE("an expression that jumps is held back by no more than Huber's loss has") {
  // The prior of the change alone: its pull grows with the way up to 1.345 deviations, and is constant beyond.
  Rig rig(0, 0, 1e-9f);
  const float sd = rig.expected.motion->expected().parameter_sd[kJaw];
  const std::size_t column = rig.egg.cascade->column_of(kJaw);
  const float own = 1 / rig.parameter(column).sd / rig.parameter(column).sd;
  const auto pull = [&](float deviations) {
    rig.egg.q[kJaw] = deviations * sd;
    rig.problem.linearise();
    return -sd * (rig.scratch->equations.g(kPoseUnknowns + column) + own * rig.egg.q[kJaw]);
  };
  CHECK(pull(0.5f) == doctest::Approx(0.5).epsilon(0.01));
  CHECK(pull(1.3f) == doctest::Approx(1.3).epsilon(0.01));
  CHECK(pull(3) == doctest::Approx(1.345).epsilon(0.01));
  CHECK(pull(6) == doctest::Approx(1.345).epsilon(0.01));
}

}  // namespace frame_problem_test
