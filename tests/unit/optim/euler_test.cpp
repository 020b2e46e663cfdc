// The published dynamics and its preconditioned forms (Eq. 9, 12, 13).
#include "pliant/euler.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>
#include <vector>

#include "dense.hpp"
#include "open_model.hpp"
#include "pliant/camera.hpp"
#include "pliant/cascade.hpp"
#include "random.hpp"

namespace euler_test {

using namespace pliant;

namespace {

/// Points of the egg, in pixels, with unknown pose and parameters. Each test chooses units and number of points.
struct EggProblem : OpenModel {
  std::vector<Vec2> uv, image;
  std::vector<float> q, trial;
  View view, trial_view;
  float stiffness;
  InArena<Cascade> cascade;
  std::vector<Vec3> samples;

  EggProblem(std::size_t points, float stiffness_, std::uint64_t seed)
      : OpenModel(egg_model(6)), stiffness(stiffness_), cascade(model) {
    Random random(seed);
    std::vector<float> truth;
    for (const Parameter& p : model.parameters())
      truth.push_back(clamp(p.sd * random.normal(), p.minimum, p.maximum));
    const View true_view =
        view_of({exp_rotation({0.1f, -0.2f, 0.05f}), {5, -8, 700}}, centred_camera(640, 480, 900));
    samples.resize(points * model.cascade().count);
    for (std::size_t i = 0; i < points; ++i) {
      uv.push_back({random.uniform(0, 1), random.uniform(0, 1)});
      Vec2 x;
      REQUIRE(Projector(true_view, true).project(cascade->surface_point(uv[i], truth.data()), &x));
      image.push_back(x);
      cascade->sample_point(uv[i], truth.data(), &samples[i * model.cascade().count]);
    }
    q.assign(truth.size(), 0.0f);
    trial = q;
    view = view_of({exp_rotation({0.05f, -0.12f, 0}), {0, 0, 740}}, centred_camera(640, 480, 900));
  }
  std::size_t unknowns() const { return kPoseUnknowns + q.size(); }
  float prior(const std::vector<float>& p) const {
    float sum = 0;
    for (std::size_t k = 0; k < p.size(); ++k) {
      const float z = p[k] / model.parameters()[k].sd;
      sum += 0.5f * stiffness * z * z;
    }
    return sum;
  }
  float linearise(NormalEquations& equations) {
    equations.reset(unknowns());
    float cost = prior(q);
    const Projector projector(view, true);
    std::vector<std::uint16_t> number;
    std::vector<Vec2> column;
    for (std::size_t i = 0; i < uv.size(); ++i) {
      Jacobian j;
      const Vec3 p = cascade->evaluate(&samples[i * model.cascade().count], q.data(), &j);
      Vec2 x;
      Projector::Derivatives d;
      if (!projector.project(p, &x, &d)) return 1e30f;
      number.clear();
      column.clear();
      for (std::uint16_t k = 0; k < kPoseUnknowns; ++k) {
        number.push_back(k);
        column.push_back(d.pose[k]);
      }
      for (std::size_t k = 0; k < j.count; ++k) {
        number.push_back(static_cast<std::uint16_t>(kPoseUnknowns + j.list[k]));
        column.push_back(d.along(j.column[j.list[k]]));
      }
      const Vec2 f = image[i] - x;
      equations.add(number.data(), column.data(), number.size(), f, {1, 0, 1});
      cost += 0.5f * dot(f, f);
    }
    for (std::size_t k = 0; k < q.size(); ++k) {
      const float sd = model.parameters()[k].sd;
      equations.add_prior(kPoseUnknowns + k, -q[k], stiffness / (sd * sd));
    }
    return cost;
  }
  float try_step(const float* step) {
    trial_view = moved(view, step, kPoseUnknowns);
    for (std::size_t k = 0; k < q.size(); ++k) trial[k] = q[k] + step[kPoseUnknowns + k];
    float cost = prior(trial);
    for (std::size_t i = 0; i < uv.size(); ++i) {
      Vec2 x;
      if (!Projector(trial_view, true)
               .project(cascade->evaluate(&samples[i * model.cascade().count], trial.data()), &x))
        return 1e30f;
      cost += 0.5f * dot(image[i] - x, image[i] - x);
    }
    return cost;
  }
  LeastSquaresProblem problem() {
    return {this, [](void* p, NormalEquations& e) { return static_cast<EggProblem*>(p)->linearise(e); },
            [](void* p, const float* s) { return static_cast<EggProblem*>(p)->try_step(s); },
            [](void* p) {
              auto& egg = *static_cast<EggProblem*>(p);
              egg.q = egg.trial;
              egg.view = egg.trial_view;
            }};
  }
  SolverReport run(const EulerOptions& options) {
    InArena<NormalEquations> equations(unknowns());
    std::vector<float> scratch(3 * unknowns());
    return integrate(problem(), options, equations.object, scratch.data());
  }
  float gauss_newton() {
    InArena<NormalEquations> equations(unknowns());
    std::vector<float> step(unknowns());
    SolverOptions options;
    options.max_accepted = 30;
    options.measured_decrease = 1e-7f;
    return minimise(problem(), options, equations.object, step.data()).final_cost;
  }
  double rms(float cost) const { return std::sqrt(2 * double(cost) / double(uv.size())); }
};

/// Linear forces in units of about one: f_i = x_i - B_i q, and K = -diag(0.5, 1, ...).
struct LinearProblem {
  static constexpr int kUnknowns = 5, kPoints = 30;
  std::vector<Vec2> column, x;
  float q[kUnknowns] = {}, trial[kUnknowns] = {}, k[kUnknowns] = {};

  explicit LinearProblem(std::uint64_t seed) {
    Random random(seed);
    for (int i = 0; i < kPoints; ++i) {
      x.push_back({random.normal(), random.normal()});
      for (int j = 0; j < kUnknowns; ++j) column.push_back({random.normal(), random.normal()});
    }
    for (int j = 0; j < kUnknowns; ++j) k[j] = 0.5f * static_cast<float>(j + 1);
  }
  float cost(const float* p) const {
    float sum = 0;
    for (int j = 0; j < kUnknowns; ++j) sum += 0.5f * k[j] * p[j] * p[j];
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Vec2 f = force(i, p);
      sum += 0.5f * dot(f, f);
    }
    return sum;
  }
  Vec2 force(std::size_t i, const float* p) const {
    Vec2 f = x[i];
    for (std::size_t j = 0; j < kUnknowns; ++j) f = f - p[j] * column[i * kUnknowns + j];
    return f;
  }
  float linearise(NormalEquations& e) const {
    const std::uint16_t all[kUnknowns] = {0, 1, 2, 3, 4};
    e.reset(kUnknowns);
    for (std::size_t i = 0; i < x.size(); ++i)
      e.add(all, &column[i * kUnknowns], kUnknowns, force(i, q), {1, 0, 1});
    for (std::size_t j = 0; j < kUnknowns; ++j) e.add_prior(j, -q[j], k[j]);
    return cost(q);
  }
  LeastSquaresProblem problem() {
    return {this, [](void* c, NormalEquations& e) { return static_cast<LinearProblem*>(c)->linearise(e); },
            [](void* c, const float* s) {
              auto& l = *static_cast<LinearProblem*>(c);
              for (int j = 0; j < kUnknowns; ++j) l.trial[j] = l.q[j] + s[j];
              return l.cost(l.trial);
            },
            [](void* c) {
              auto& l = *static_cast<LinearProblem*>(c);
              for (int j = 0; j < kUnknowns; ++j) l.q[j] = l.trial[j];
            }};
  }
};

/// The same in double precision.
struct LinearReference {
  Eigen::MatrixXd b = Eigen::MatrixXd(2 * LinearProblem::kPoints, LinearProblem::kUnknowns);
  Eigen::VectorXd x = Eigen::VectorXd(2 * LinearProblem::kPoints),
                  k = Eigen::VectorXd(LinearProblem::kUnknowns);

  explicit LinearReference(const LinearProblem& p) {
    for (int i = 0; i < p.kPoints; ++i) {
      x(2 * i) = double(p.x[std::size_t(i)].x);
      x(2 * i + 1) = double(p.x[std::size_t(i)].y);
      for (int j = 0; j < p.kUnknowns; ++j) {
        b(2 * i, j) = double(p.column[std::size_t(i * p.kUnknowns + j)].x);
        b(2 * i + 1, j) = double(p.column[std::size_t(i * p.kUnknowns + j)].y);
      }
    }
    for (int j = 0; j < p.kUnknowns; ++j) k(j) = -double(p.k[j]);
  }
  /// Plain integration from 0.
  Eigen::VectorXd integrated(int steps, double length) const {
    Eigen::VectorXd q = Eigen::VectorXd::Zero(LinearProblem::kUnknowns);
    for (int step = 0; step < steps; ++step) {
      const Eigen::VectorXd error = x - b.lazyProduct(q);
      q += length * (k.cwiseProduct(q) + b.transpose().lazyProduct(error));
    }
    return q;
  }
  Eigen::VectorXd limit() const {
    Eigen::MatrixXd h = Eigen::MatrixXd::Zero(LinearProblem::kUnknowns, LinearProblem::kUnknowns);
    h.diagonal() = -k;
    add_product(h, b, b);
    return solve_symmetric(h, b.transpose().lazyProduct(x));
  }
};

}  // namespace

TEST_CASE(
    "Eq. 12 and 13: with units of its size the published step follows the plain integration, stiffness "
    "included") {
  constexpr int kUnknowns = LinearProblem::kUnknowns, kSteps = 600;
  LinearProblem linear(7);
  InArena<NormalEquations> equations(std::size_t{kUnknowns});
  std::vector<float> scratch(3 * kUnknowns);
  const SolverReport report = integrate(linear.problem(), EulerOptions{}, equations.object, scratch.data());
  CHECK(report.iterations == kSteps);
  CHECK(report.stop_reason == StopReason::iteration_limit);
  const LinearReference reference(linear);
  const Eigen::VectorXd q = reference.integrated(kSteps, 1e-3);
  for (int j = 0; j < kUnknowns; ++j)
    CHECK(double(linear.q[j]) == doctest::Approx(q(j)).epsilon(1e-4).scale(1));
  CHECK((q - reference.limit()).norm() < 1e-3);  // 600 steps of 1e-3 arrive, with eigenvalues around 60
}

TEST_CASE("in pixels the published step diverges, and says so") {
  EggProblem egg(100, 1, 3);
  const SolverReport report = egg.run({});
  CHECK(report.stop_reason == StopReason::diverged);
  CHECK(report.iterations < 10);
}

TEST_CASE("the preconditioned steps arrive with the same settings for 100 and for 1900 points") {
  for (std::size_t points : {std::size_t{100}, std::size_t{1900}})
    for (EulerStep kind : {EulerStep::preconditioned, EulerStep::barzilai_borwein}) {
      EggProblem egg(points, 1, 5), exact(points, 1, 5);
      const float best = exact.gauss_newton();
      EulerOptions options;
      options.step = kind;
      options.relative_decrease = 1e-5f;
      options.steps = kind == EulerStep::preconditioned ? 6000 : 600;
      const SolverReport report = egg.run(options);
      const char* name = kind == EulerStep::preconditioned ? "safe step" : "Barzilai-Borwein";
      std::printf("%zu points, %s: %d steps, rms %.3f -> %.4f px, optimum %.4f\n", points, name,
                  report.iterations, egg.rms(report.initial_cost), egg.rms(report.final_cost), egg.rms(best));
      // It has also converged where floats no longer distinguish two costs.
      CHECK((report.stop_reason == StopReason::converged || report.stop_reason == StopReason::no_decrease));
      CHECK(egg.rms(report.final_cost) < egg.rms(best) + 0.05);
    }
}

TEST_CASE("preconditioned steps never raise the cost; those of Barzilai and Borwein may, and end lower") {
  float lowest[2] = {};
  bool rises[2] = {};
  for (const EulerStep kind : {EulerStep::preconditioned, EulerStep::barzilai_borwein}) {
    const int k = kind == EulerStep::barzilai_borwein;
    struct Watched {
      EggProblem egg{100, 1, 5};
      float cost = 1e30f;
      bool rises = false;
    } watched;
    LeastSquaresProblem problem = watched.egg.problem();
    problem.context = &watched;
    problem.linearise = [](void* c, NormalEquations& e) {
      Watched& w = *static_cast<Watched*>(c);
      const float cost = w.egg.linearise(e);
      w.rises = w.rises || cost > w.cost;
      return w.cost = cost;
    };
    problem.try_step = [](void* c, const float* s) { return static_cast<Watched*>(c)->egg.try_step(s); };
    problem.accept = [](void* c) {
      EggProblem& egg = static_cast<Watched*>(c)->egg;
      egg.q = egg.trial;
      egg.view = egg.trial_view;
    };
    InArena<NormalEquations> equations(watched.egg.unknowns());
    std::vector<float> scratch(3 * watched.egg.unknowns());
    EulerOptions options;
    options.step = kind;
    options.relative_decrease = 0;  // on to where floats no longer distinguish two costs
    options.steps = 5000;
    lowest[k] = integrate(problem, options, equations.object, scratch.data()).final_cost;
    rises[k] = watched.rises;
  }
  CHECK_FALSE(rises[0]);
  CHECK(rises[1]);
  CHECK(lowest[1] < lowest[0]);
}

TEST_CASE("steps along the force stay within the limits") {
  EggProblem egg(60, 1, 6);
  struct Limited {
    EggProblem& egg;
  } limited{egg};
  const LeastSquaresProblem problem{
      &limited,
      [](void* c, NormalEquations& e) {
        EggProblem& p = static_cast<Limited*>(c)->egg;
        const float cost = p.linearise(e);
        for (std::size_t k = 0; k < p.q.size(); ++k)
          e.set_limits(kPoseUnknowns + k, -0.1f - p.q[k], 0.1f - p.q[k]);
        return cost;
      },
      [](void* c, const float* s) { return static_cast<Limited*>(c)->egg.try_step(s); },
      [](void* c) {
        EggProblem& p = static_cast<Limited*>(c)->egg;
        p.q = p.trial;
        p.view = p.trial_view;
      }};
  InArena<NormalEquations> equations(egg.unknowns());
  std::vector<float> scratch(3 * egg.unknowns());
  EulerOptions options;
  options.step = EulerStep::barzilai_borwein;
  const SolverReport report = integrate(problem, options, equations.object, scratch.data());
  CHECK(report.final_cost < report.initial_cost);
  bool at_limit = false;
  for (float v : egg.q) {
    CHECK(magnitude(v) <= 0.1001f);
    at_limit = at_limit || magnitude(v) > 0.0999f;
  }
  CHECK(at_limit);
}

TEST_CASE("an unknown that nothing observes stays where it is, and the others arrive") {
  struct Plane {
    float x[3] = {5, 7, -3}, trial[3] = {};
    static float cost(const float* x) { return 0.5f * (x[0] * x[0] + 9 * x[2] * x[2]); }
  };
  for (const EulerStep kind : {EulerStep::preconditioned, EulerStep::barzilai_borwein}) {
    Plane plane;
    const LeastSquaresProblem problem{&plane,
                                      [](void* c, NormalEquations& equations) {
                                        const float* const x = static_cast<Plane*>(c)->x;
                                        equations.reset(3);
                                        const std::uint16_t unknown[] = {0, 2};
                                        const Vec2 column[] = {{1, 0}, {0, 1}};
                                        equations.add(unknown, column, 2, {-x[0], -x[2]}, {1, 0, 9});
                                        return Plane::cost(x);
                                      },
                                      [](void* c, const float* step) {
                                        Plane& p = *static_cast<Plane*>(c);
                                        for (int k = 0; k < 3; ++k) p.trial[k] = p.x[k] + step[k];
                                        return Plane::cost(p.trial);
                                      },
                                      [](void* c) {
                                        Plane& p = *static_cast<Plane*>(c);
                                        for (int k = 0; k < 3; ++k) p.x[k] = p.trial[k];
                                      }};
    InArena<NormalEquations> equations(std::size_t{3});
    float scratch[9];
    EulerOptions options;
    options.step = kind;
    options.steps = 200;
    CHECK(integrate(problem, options, equations.object, scratch).final_cost < 1e-6f);
    CHECK(plane.x[1] == 7);
  }
}

}  // namespace euler_test
