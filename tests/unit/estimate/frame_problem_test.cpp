// The cost of a frame and its equations: observations, priors, springs.
#include "estimate/frame_problem.hpp"

#include <doctest/doctest.h>

#include <utility>

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

TEST_CASE("observations in any order are measured against the predictions of their own points") {
  Rig rig(0.05f, 0.1f, 4);
  const Projector projector(rig.egg.state.view, true);
  std::vector<Prediction> predictions(kPoints);
  Vec3 unused;
  for (std::uint16_t id = 0; id < kPoints; ++id)
    REQUIRE(rig.points->predict(id, {rig.egg.cascade.object, rig.input.expected, rig.egg.state, projector},
                                &predictions[id], &unused));
  Random random(5);
  for (std::size_t k = kPoints - 1; k > 0; --k) std::swap(rig.seen[k], rig.seen[random.below(k + 1)]);
  rig.rows->gather({rig.seen.data(), rig.seen.size()}, rig.points.object, rig.egg.state.view.s);
  rig.problem.measure();
  std::vector<Vec2> own;
  for (std::size_t k = 0; k < kPoints; ++k) own.push_back(rig.rows->residual(k));
  rig.problem.measure({predictions.data(), predictions.size()});
  for (std::size_t k = 0; k < kPoints; ++k) CHECK(length(rig.rows->residual(k) - own[k]) == 0);
}

TEST_CASE("a row that is not kept, and one whose point is behind the camera, is in no equation") {
  Rig all(0.02f, 0, 4), some(0.02f, 0, 4);
  const auto same_equations = [&] {
    for (std::size_t k = 0; k < all.unknowns; ++k)
      if (all.scratch->equations.g(k) != some.scratch->equations.g(k) ||
          all.scratch->equations.h(k, k) != some.scratch->equations.h(k, k))
        return false;
    return true;
  };
  all.seen.erase(all.seen.begin() + 7, all.seen.begin() + 12);
  all.rows->gather({all.seen.data(), all.seen.size()}, all.points.object, all.egg.state.view.s);
  const auto cost = [](Rig& rig) { return rig.problem.linearise(); };
  CHECK(cost(all) < cost(some));
  CHECK_FALSE(same_equations());
  for (std::size_t k = 7; k < 12; ++k) some.rows.object[k].is_kept = false;
  CHECK(cost(all) == cost(some));
  CHECK(same_equations());
  Rig near(0, 0, 4);  // so near that the camera is within the egg
  near.egg.state.view.rho = near.problem.state.view.rho = 0.02f;
  const Projector projector(near.egg.state.view, true);
  const auto gradient = [&] {
    near.problem.linearise();
    std::vector<float> g;
    for (std::size_t k = 0; k < near.unknowns; ++k) g.push_back(near.scratch->equations.g(k));
    return g;
  };
  const std::vector<float> before = gradient();
  std::size_t behind = 0;
  for (std::size_t k = 0; k < kPoints; ++k) {
    float b[2 * kPoseUnknowns];
    if (near.problem.pose_jacobian(k, projector, b)) continue;
    ++behind;
    near.rows.object[k].is_kept = false;
  }
  CHECK(behind > 0);
  CHECK(behind < kPoints);
  CHECK(gradient() == before);
}

TEST_CASE("the total cost is Tukey's over all rows, in the scale that is asked for") {
  Rig rig(0.03f, 0.1f, 4);
  rig.seen[3].x = rig.seen[3].x + Vec2{20, -10};
  rig.problem.loss = Loss::tukey;
  for (const float scale : {1.0f, 2.5f}) {
    rig.problem.scale = scale;
    const float all = rig.problem.linearise();
    rig.rows.object[3].is_kept = rig.rows.object[20].is_kept = false;
    rig.problem.scale = 1.7f;
    CHECK(rig.problem.total_cost(scale) == all);
    rig.rows.object[3].is_kept = rig.rows.object[20].is_kept = true;
  }
}

TEST_CASE("one step turns, and scales, by no more than the limit, and leaves parameters in their ranges") {
  constexpr float kMost = kFrameProblemTuning.most_step;
  for (const bool is_far : {false, true}) {
    Rig rig(is_far ? 0.0f : 1.2f, 0, 100);
    if (is_far) {
      rig.truth.pose({{}, {1, 5, 2500}});
      for (Observation& o : rig.seen) o.x = rig.truth.image_of(rig.points->uv(o.id));
    }
    const View before = rig.problem.state.view;
    SolverReport report;
    rig.problem.minimise(1, 1e-3f, &report);
    const View after = rig.problem.state.view;
    const Vec3 turn = log_rotation(after.q * conjugate(before.q));
    const float most_turn = 1.7321f * kMost * 1.0001f;  // of three turns
    CHECK(length(turn) > 0.1f * kMost * (is_far ? 0.0f : 1.0f));
    CHECK(length(turn) <= most_turn);
    CHECK(magnitude(after.s / before.s - 1) <= kMost * 1.0001f + 0.5f * kMost * kMost);
  }
  for (const float jaw : {0.7f, -0.2f}) {  // of a range from 0 to 0.5
    Rig rig(0, jaw, 100);
    SolverReport report;
    rig.problem.minimise(20, 1e-5f, &report);
    CHECK(rig.egg.q[kJaw] == (jaw > 0 ? 0.5f : 0.0f));
  }
}

TEST_CASE("a minimisation leaves the rows as they are measured at the state where it ends, however it ends") {
  int refused = 0;
  for (int iterations = 1; iterations < 30; iterations += 4)
    for (const float turn : {0.05f, 0.4f, 0.9f}) {
      Rig rig(turn, 0.3f, 4);
      for (std::size_t k = 0; k < kPoints; k += 5) rig.seen[k].x = rig.seen[k].x + Vec2{30, -20};
      rig.problem.loss = Loss::tukey;
      rig.problem.measure();
      rig.problem.scale = rig.rows->scale();
      SolverReport report;
      rig.problem.minimise(iterations, 0, &report);  // as long as the cost falls
      std::vector<float> lengths;
      for (std::size_t k = 0; k < kPoints; ++k) lengths.push_back(rig.rows->length(k));
      rig.problem.measure();
      for (std::size_t k = 0; k < kPoints; ++k) CHECK(rig.rows->length(k) == lengths[k]);
      refused += report.ends_with_refused_step;
    }
  CHECK(refused > 0);
}

TEST_CASE("from a state beside the expected one the pose's prior leads back by the step that led there") {
  Rig rig(0, 0, 1e-9f);
  const View expected = view_of({exp_rotation({0.4f, -0.7f, 0.3f}), {10, 5, 600}}, rig.egg.camera);
  rig.expected.motion->expect(expected);
  const float step[kPoseUnknowns] = {0.2f, -0.1f, 0.15f, 0, 4, -3};
  rig.problem.state.view = moved(expected, step, kPoseUnknowns);
  rig.problem.linearise();
  for (std::size_t k = 0; k < kPoseUnknowns; ++k) {
    CAPTURE(k);
    const float back = rig.scratch->equations.g(k) / rig.scratch->equations.h(k, k);
    CHECK(magnitude(back + step[k]) < 1e-3f * (1 + magnitude(step[k])));  // observations weigh 1e-9 / px^2
  }
}

}  // namespace frame_problem_test
