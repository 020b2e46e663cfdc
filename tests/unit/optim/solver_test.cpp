#include "pliant/solver.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <vector>

#include "aligned_block.hpp"
#include "dense.hpp"
#include "pliant/robust.hpp"
#include "random.hpp"

namespace solver_test {

using namespace pliant;

namespace {

struct Equations {
  AlignedBlock block;
  Arena arena;
  NormalEquations equations;
  explicit Equations(std::size_t n)
      : block(measured_bytes<NormalEquations>(n)), arena(block.data(), block.size()) {
    REQUIRE(create_in(arena, equations, n) == Status::ok);
  }
};

/// Random sparse image observations into `e`, and the same in double.
void fill(NormalEquations& e, std::size_t n, Random& random, Eigen::MatrixXd& h, Eigen::VectorXd& g) {
  const auto size = static_cast<Eigen::Index>(n);
  h = Eigen::MatrixXd::Zero(size, size);
  g = Eigen::VectorXd::Zero(size);
  e.reset(n);
  for (int i = 0; i < 60; ++i) {
    std::vector<std::uint16_t> unknown;
    std::vector<Vec2> column;
    Eigen::MatrixXd b = Eigen::MatrixXd::Zero(2, size);
    for (std::size_t k = 0; k < n; ++k)
      if (k < 6 || random.below(3) == 0) {
        unknown.push_back(static_cast<std::uint16_t>(k));
        const float unit = k == 0 ? 100.0f : 1.0f;  // badly scaled on purpose
        column.push_back({unit * random.normal(), unit * random.normal()});
        b(0, static_cast<Eigen::Index>(k)) = double(column.back().x);
        b(1, static_cast<Eigen::Index>(k)) = double(column.back().y);
      }
    const Vec2 r{random.normal(), random.normal()};
    const float c = random.normal(), s = random.normal();
    const Sym2 w{c * c + 0.1f, c * s, s * s + 0.1f};
    e.add(unknown.data(), column.data(), column.size(), r, w);
    Eigen::Matrix2d wd;
    wd << double(w.xx), double(w.xy), double(w.xy), double(w.yy);
    const Eigen::MatrixXd weighted = wd.lazyProduct(b);
    add_product(h, b, weighted);
    g += weighted.transpose().lazyProduct(Eigen::Vector2d(double(r.x), double(r.y)));
  }
}

}  // namespace

TEST_CASE("accumulated equations and their solution agree with double precision") {
  for (std::size_t n : {1u, 6u, 17u, 40u}) {
    Equations e(n);
    Random random(n);
    Eigen::MatrixXd h;
    Eigen::VectorXd g;
    fill(e.equations, n, random, h, g);
    std::vector<float> step(n), variance(n);
    e.equations.solve(0, step.data());
    const Eigen::VectorXd exact = solve_symmetric(h, g);
    const Eigen::MatrixXd inverse = solve_symmetric(h, Eigen::MatrixXd::Identity(h.rows(), h.cols()));
    e.equations.variances(variance.data());
    for (std::size_t k = 0; k < n; ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      CHECK(double(step[k]) == doctest::Approx(exact(i)).epsilon(1e-3));
      CHECK(double(variance[k]) == doctest::Approx(inverse(i, i)).epsilon(1e-3));
    }
  }
}

TEST_CASE("limits hold, and the other unknowns take the best value given them") {
  const std::size_t n = 8;
  Equations e(n);
  Random random(5);
  Eigen::MatrixXd h;
  Eigen::VectorXd g;
  fill(e.equations, n, random, h, g);
  std::vector<float> free_step(n), step(n);
  e.equations.solve(0, free_step.data());
  const float bound = 0.4f * magnitude(free_step[7]);
  e.equations.set_limits(7, -bound, bound);
  e.equations.solve(0, step.data());
  CHECK(magnitude(step[7]) == doctest::Approx(double(bound)));
  Eigen::VectorXd x(8);
  for (int k = 0; k < 8; ++k) x(k) = double(step[static_cast<std::size_t>(k)]);
  const Eigen::VectorXd gradient = g - h.lazyProduct(x);
  for (int k = 0; k < 7; ++k) CHECK(std::abs(gradient(k)) < 1e-3 * std::sqrt(h(k, k)));
  CHECK(gradient(7) * x(7) > 0);  // it would still like to go further
}

TEST_CASE("with many limits the step is the best within them: forces at each push outwards or not at all") {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const std::size_t n = 20;
    Equations e(n);
    Random random(seed);
    Eigen::MatrixXd h;
    Eigen::VectorXd g;
    fill(e.equations, n, random, h, g);
    std::vector<float> free_step(n), step(n);
    e.equations.solve(0, free_step.data());
    for (std::size_t k = 6; k < n; ++k) {  // some start on a limit, as parameters at rest do
      const float size = 0.5f * magnitude(free_step[k]);
      e.equations.set_limits(k, random.below(2) == 0 ? 0.0f : -size, random.below(2) == 0 ? 0.0f : size);
    }
    e.equations.solve(0, step.data());
    Eigen::VectorXd x(20);
    for (std::size_t k = 0; k < n; ++k) x(Eigen::Index(k)) = double(step[k]);
    const Eigen::VectorXd force = g - h.lazyProduct(x);
    const double largest = (g.array() / h.diagonal().array().sqrt()).abs().maxCoeff();
    for (std::size_t k = 0; k < n; ++k) {
      const auto i = Eigen::Index(k);
      const double scaled = force(i) / std::sqrt(h(i, i));
      const bool may_grow = e.equations.clamped(k, step[k] + 1e-3f * magnitude(free_step[k])) > step[k];
      const bool may_shrink = e.equations.clamped(k, step[k] - 1e-3f * magnitude(free_step[k])) < step[k];
      if (may_grow) CHECK(scaled < 3e-3 * largest);
      if (may_shrink) CHECK(scaled > -3e-3 * largest);
    }
  }
}

TEST_CASE("an unobserved unknown stays and is counted") {
  Equations e(4);
  e.equations.reset(4);
  const std::uint16_t unknown[3] = {0, 1, 3};
  const Vec2 column[3] = {{1, 0}, {0, 1}, {1, 1}};  // unknown 3 is the sum of 0 and 1; 2 is never seen
  for (int i = 0; i < 5; ++i) e.equations.add(unknown, column, 3, {1, 2}, {1, 0, 1});
  float step[4];
  e.equations.solve(0, step);
  CHECK(e.equations.undetermined_count() == 2);
  CHECK(step[2] == 0);
  CHECK(step[3] == 0);
  CHECK(step[0] == doctest::Approx(1));
  CHECK(step[1] == doctest::Approx(2));
}

TEST_CASE("an unknown that another one hides is determined once that is held at its limit") {
  Equations e(3);
  const std::uint16_t unknown[2] = {0, 1};
  const Vec2 column[2] = {{1, 0}, {1, 0}};  // only their sum is seen; 2 is never seen
  const auto solve = [&](float lower, float upper, float* step) {
    e.equations.reset(3);
    e.equations.add(unknown, column, 2, {10, 0}, {1, 0, 1});
    e.equations.set_limits(0, lower, upper);
    e.equations.solve(0, step);
  };
  float step[3];
  solve(-1, 1, step);
  CHECK(step[0] == 1);
  CHECK(step[1] == doctest::Approx(9));
  CHECK(e.equations.undetermined_count() == 1);
  solve(-20, 20, step);  // no limit is reached
  CHECK(step[0] == doctest::Approx(10));
  CHECK(step[1] == 0);
  CHECK(step[2] == 0);
  CHECK(e.equations.undetermined_count() == 2);
}

/// A problem of n unknowns, by its cost and its equations at x.
template <std::size_t n>
struct Problem {
  float (*cost)(const float* x);
  void (*linearise)(const float* x, NormalEquations& equations);
  float x[n] = {}, trial[n] = {};

  SolverReport minimise(const SolverOptions& options) {
    Equations e(n);
    float step[n];
    const LeastSquaresProblem problem{this,
                                      [](void* p, NormalEquations& equations) {
                                        const auto& self = *static_cast<Problem*>(p);
                                        equations.reset(n);
                                        self.linearise(self.x, equations);
                                        return self.cost(self.x);
                                      },
                                      [](void* p, const float* by) {
                                        auto& self = *static_cast<Problem*>(p);
                                        for (std::size_t k = 0; k < n; ++k) self.trial[k] = self.x[k] + by[k];
                                        return self.cost(self.trial);
                                      },
                                      [](void* p) {
                                        auto& self = *static_cast<Problem*>(p);
                                        std::copy_n(self.trial, n, self.x);
                                      }};
    return pliant::minimise(problem, options, e.equations, step);
  }
};

/// Rosenbrock's function, halved.
Problem<2> valley() {
  return {[](const float* x) {
            const float a = 10 * (x[1] - x[0] * x[0]), b = 1 - x[0];
            return 0.5f * (a * a + b * b);
          },
          [](const float* x, NormalEquations& equations) {
            const std::uint16_t unknown[2] = {0, 1};
            const Vec2 column[2] = {{-20 * x[0], -1}, {10, 0}};
            equations.add(unknown, column, 2, {-10 * (x[1] - x[0] * x[0]), -(1 - x[0])}, {1, 0, 1});
          },
          {-1.2f, 1}};
}

TEST_CASE("the minimiser finds the bottom of Rosenbrock's valley") {
  Problem<2> problem = valley();
  SolverOptions options;
  options.max_accepted = 60;
  const SolverReport report = problem.minimise(options);
  CHECK(report.stop_reason != StopReason::iteration_limit);
  CHECK(report.final_cost < 1e-8f);
  CHECK(problem.x[0] == doctest::Approx(1).epsilon(1e-3));
  CHECK(problem.x[1] == doctest::Approx(1).epsilon(1e-3));
  CHECK(report.iterations < 60);  // trial steps, with those refused
}

TEST_CASE("limits of steps end the minimiser where it is") {
  SolverOptions accepted;
  accepted.max_accepted = 2;
  SolverOptions tried;
  tried.max_accepted = 60;
  tried.max_steps = 3;
  for (const SolverOptions& options : {accepted, tried}) {
    Problem<2> problem = valley();
    const SolverReport report = problem.minimise(options);
    CHECK(report.stop_reason == StopReason::iteration_limit);
    CHECK(report.iterations >= 2);
    CHECK(report.iterations <= options.max_steps);
    CHECK(report.final_cost < report.initial_cost);
    CHECK(report.final_cost == problem.cost(problem.x));
  }
  SolverOptions none;
  none.max_steps = 0;
  Problem<2> problem = valley();
  CHECK(problem.minimise(none).iterations == 0);
  CHECK(problem.x[0] == -1.2f);
}

TEST_CASE("small decreases, measured or predicted, end the minimiser early") {
  SolverOptions exact;
  exact.max_accepted = 60;
  SolverOptions measured = exact, predicted = exact;
  measured.measured_decrease = 0.5f;
  predicted.measured_decrease = 0;
  predicted.predicted_decrease = 0.9f;
  Problem<2> best = valley();
  const SolverReport to_the_end = best.minimise(exact);
  for (const SolverOptions& options : {measured, predicted}) {
    Problem<2> problem = valley();
    const SolverReport report = problem.minimise(options);
    CHECK(report.stop_reason == StopReason::converged);
    CHECK(report.iterations < to_the_end.iterations);
  }
}

TEST_CASE("steps that never lower the cost, or make it NaN, end the minimiser after `max_refused`") {
  const auto slope = [](const float* x, NormalEquations& equations) {
    const std::uint16_t unknown[1] = {0};
    const Vec2 column[1] = {{1, 0}};
    equations.add(unknown, column, 1, {1 - x[0], 0}, {1, 0, 0});
  };
  Problem<1> level{[](const float*) { return 1.0f; }, slope};
  Problem<1> hole{[](const float* x) { return x[0] > 0 ? std::numeric_limits<float>::quiet_NaN() : 1.0f; },
                  slope};
  for (Problem<1>* problem : {&level, &hole})
    for (const int most : {1, 4}) {
      SolverOptions options;
      options.max_refused = most;
      const SolverReport report = problem->minimise(options);
      CHECK(report.stop_reason == StopReason::no_decrease);
      CHECK(report.ends_with_refused_step);
      CHECK(report.iterations == most);
      CHECK(report.final_cost == 1);
      CHECK(problem->x[0] == 0);
    }
}

TEST_CASE("the minimiser counts the unknowns that no observation determines") {
  Problem<3> line{
      [](const float* x) { return 0.5f * (x[0] + x[1] - 4) * (x[0] + x[1] - 4); },
      [](const float* x, NormalEquations& equations) {  // only the sum of the first two is observed
        const std::uint16_t unknown[] = {0, 1};
        const Vec2 column[] = {{1, 0}, {1, 0}};
        equations.add(unknown, column, 2, {4 - x[0] - x[1], 0}, {1, 0, 0});
      }};
  const SolverReport report = line.minimise({});
  CHECK(report.final_cost < 1e-6f);
  CHECK(report.undetermined == 1);
  CHECK(line.x[2] == 0);
}

TEST_CASE("robust losses are squares near zero and continuous, and Tukey's weight ends at zero") {
  for (Loss loss : {Loss::squares, Loss::huber, Loss::tukey}) {
    CHECK(evaluate(loss, 0.01f).rho == doctest::Approx(5e-5).epsilon(1e-3));
    CHECK(evaluate(loss, 0).weight == doctest::Approx(1));
    float last = 0;
    for (float u = 0; u < 8; u += 0.01f) {
      const LossValue v = evaluate(loss, u);
      CHECK(v.rho >= last - 1e-5f);
      CHECK(v.rho - last < 0.09f);
      const float h = 1e-2f;  // weight = rho'(u) / u
      if (u > 0.1f && u < 4.6f) {
        const float slope = (evaluate(loss, u + h).rho - evaluate(loss, u - h).rho) / (2 * h);
        CHECK(v.weight * u == doctest::Approx(double(slope)).epsilon(0.02));
      }
      last = v.rho;
    }
  }
  CHECK(evaluate(Loss::tukey, 5).weight == 0);
}

TEST_CASE("select gives the k-th smallest, and the scale of Rayleigh lengths is one") {
  Random random(9);
  std::vector<float> values(101), lengths(4000);
  for (std::size_t k = 0; k < values.size(); ++k) {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>((i * 37) % 101);
    CHECK(select(values.data(), values.size(), k) == static_cast<float>(k));
  }
  // Orders and repetitions that make bad pivots.
  for (std::size_t n : {1u, 2u, 16u, 17u, 64u, 1000u})
    for (int kind = 0; kind < 5; ++kind) {
      std::vector<float> ordered(n);
      for (std::size_t i = 0; i < n; ++i) {
        const auto at = static_cast<float>(i), mirrored = static_cast<float>(i < n / 2 ? i : n - i);
        ordered[i] = kind == 0   ? at
                     : kind == 1 ? -at
                     : kind == 2 ? 3.0f
                     : kind == 3 ? mirrored
                                 : static_cast<float>(random.below(4));
      }
      std::vector<float> sorted = ordered;
      std::sort(sorted.begin(), sorted.end());
      for (std::size_t k = 0; k < n; k += n / 7 + 1) {
        std::vector<float> shuffled = ordered;
        CHECK(select(shuffled.data(), n, k) == sorted[k]);
        std::sort(shuffled.begin(), shuffled.end());
        CHECK(shuffled == sorted);  // reordered, nothing lost
      }
    }
  std::vector<float> undefined(100, std::numeric_limits<float>::quiet_NaN());
  undefined[3] = 1;
  select(undefined.data(), undefined.size(), 50);  // ends
  for (float& l : lengths) l = length(Vec2{random.normal(), random.normal()});
  CHECK(robust_scale(lengths.data(), lengths.size()) == doctest::Approx(1).epsilon(0.05));
  CHECK(robust_scale(lengths.data(), 0) == 0);
}

TEST_CASE("a dense observation adds what the same columns add by number") {
  constexpr std::size_t kCount = 9;
  Random random(5);
  for (const bool only_gradient : {false, true}) {
    Equations dense(kCount), numbered(kCount);
    dense.equations.reset(kCount);
    numbered.equations.reset(kCount);
    dense.equations.keep_gradient_only(only_gradient);
    numbered.equations.keep_gradient_only(only_gradient);
    for (int i = 0; i < 30; ++i) {
      float along_x[kCount], along_y[kCount];
      Vec2 column[kCount];
      std::uint16_t unknown[kCount];
      for (std::size_t k = 0; k < kCount; ++k) {
        along_x[k] = random.normal();
        along_y[k] = random.normal();
        column[k] = {along_x[k], along_y[k]};
        unknown[k] = static_cast<std::uint16_t>(k);
      }
      const Vec2 residual{random.normal(), random.normal()};
      const Sym2 w{2, 0.5f, 1};
      dense.equations.add_dense(along_x, along_y, residual, w);
      numbered.equations.add(unknown, column, kCount, residual, w);
    }
    for (std::size_t k = 0; k < kCount; ++k) {
      CHECK(dense.equations.g(k) == doctest::Approx(double(numbered.equations.g(k))).epsilon(1e-4).scale(1));
      CHECK(dense.equations.h(k, k) == doctest::Approx(double(numbered.equations.h(k, k))).epsilon(1e-4));
    }
    if (!only_gradient)
      CHECK(dense.equations.h(1, 4) == doctest::Approx(double(numbered.equations.h(1, 4))).epsilon(1e-4));
  }
}

}  // namespace solver_test
