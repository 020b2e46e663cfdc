// Time, steps and accuracy of the solver on fitting problems that are text files. The optimum of each is known.
#include <cmath>
#include <cstdint>
#include <map>

#include "host/bench/bench.hpp"
#include "host/bench/fit_problem.hpp"
#include "host/bench/rows.hpp"
#include "host/io/csv.hpp"
#include "host/io/failure.hpp"
#include "host/io/owned.hpp"
#include "host/learn/sample_random.hpp"

namespace pliant::host {

namespace {

constexpr int kProblems = 10, kRepeats = 15;
constexpr std::size_t kProblemsOfDynamics = 3;  // few, because each takes long

/// Box and Muller's normal number, as the program has it that wrote the problems: the sequence continues theirs.
double normal(learn::SplitMix& random) {
  double u = random.uniform();
  while (u <= 0) u = random.uniform();
  return std::sqrt(-2 * std::log(u)) * std::cos(6.283185307179586 * random.uniform());
}

/// One problem and its initial state.
struct Case {
  LinearShapeFit fit;
  std::vector<double> camera, coefficients;
  double optimum = 0;

  explicit Case(const std::string& path)
      : fit(path), camera(fit.camera_start()), coefficients(fit.mode_count(), 0.0) {}

  /// Initial state of tracking: near the truth. Skips the random numbers that were used for the outliers.
  void start_near_truth(std::uint64_t seed) {
    learn::SplitMix random{seed};
    for (std::size_t i = 0; i < 2 * (fit.point_count() / 10); ++i) random.uniform();
    camera = fit.camera_true();
    coefficients = fit.coefficients_true();
    for (std::size_t i = 0; i < 6; ++i) camera[i] += (i < 3 ? 0.02 : 3.0) * normal(random);
    for (double& c : coefficients) c += 0.2 * normal(random);
  }
};

using Solve = SolverReport (*)(LinearShapeFit& fit, NormalEquations& equations, float* scratch);

SolverReport gauss_newton(LinearShapeFit& fit, NormalEquations& equations, float* scratch) {
  SolverOptions options;
  options.max_accepted = 60;
  options.measured_decrease = 3e-4f;
  return minimise(fit.problem(), options, equations, scratch);
}

SolverReport dynamics(LinearShapeFit& fit, NormalEquations& equations, float* scratch, EulerStep step,
                      int steps) {
  EulerOptions options;
  options.step = step;
  options.steps = steps;
  options.relative_decrease = step == EulerStep::published ? 0 : 1e-5f;
  return integrate(fit.problem(), options, equations, scratch);
}

class FitBench {
 public:
  FitBench(std::ostream& out, const std::string& folder) : row(out, "fit"), folder_(folder) {
    const std::string path = folder + "/solutions.csv";
    const CsvTable table(path, read_file(path));
    const std::size_t name = table.column("problem"), prior = table.column("prior"),
                      cost = table.column("cost");
    for (std::size_t r = 0; r < table.row_count(); ++r)
      optimum_[table.cell(r, name) + "/" + table.cell(r, prior)] = static_cast<double>(table.number(r, cost));
  }

  void run_full(int points) {
    const std::string kind = "fit_full_" + std::to_string(points) + "_";
    for (bool prior : {true, false}) {
      auto cases = read(kind, prior);
      for (Case& c : cases) c.fit.set_prior(prior);
      const std::string name = "full107_n" + std::to_string(points) + (prior ? "_prior" : "_noprior");
      measure(name + "_gauss_newton", cases, gauss_newton, kRepeats);
      if (!prior) continue;
      measure(
          name + "_euler_published", cases,
          [](LinearShapeFit& f, NormalEquations& e, float* s) {
            return dynamics(f, e, s, EulerStep::published, 600);
          },
          1);
      measure(
          name + "_euler_preconditioned", cases,
          [](LinearShapeFit& f, NormalEquations& e, float* s) {
            return dynamics(f, e, s, EulerStep::preconditioned, 10000);
          },
          1);
      measure(
          name + "_euler_barzilai_borwein", cases,
          [](LinearShapeFit& f, NormalEquations& e, float* s) {
            return dynamics(f, e, s, EulerStep::barzilai_borwein, 30000);
          },
          1);
    }
  }

  void run_track(int points) {
    auto cases = read("fit_track_" + std::to_string(points) + "_", true);
    for (std::size_t s = 0; s < cases.size(); ++s) {
      cases[s].fit.set_focal_known(true);
      cases[s].fit.set_loss(Loss::huber);
      cases[s].start_near_truth(9000 + s);
    }
    const std::string name = "track18_n" + std::to_string(points) + "_huber";
    measure(name + "_gauss_newton", cases, gauss_newton, kRepeats);
    cases.erase(cases.begin() + kProblemsOfDynamics, cases.end());
    measure(
        name + "_euler_barzilai_borwein", cases,
        [](LinearShapeFit& f, NormalEquations& e, float* s) {
          return dynamics(f, e, s, EulerStep::barzilai_borwein, 3000);
        },
        1);
  }

 private:
  std::vector<Case> read(const std::string& kind, bool prior) {
    std::vector<Case> cases;
    for (int s = 0; s < kProblems; ++s) {
      const std::string name = kind + std::to_string(s);
      cases.emplace_back(folder_ + "/" + name + ".txt");
      const auto found = optimum_.find(name + (prior ? "/1" : "/0"));
      if (found == optimum_.end()) fail_input(folder_ + "/solutions.csv", "has no optimum of " + name);
      cases.back().optimum = found->second;
    }
    return cases;
  }

  void measure(const std::string& variant, std::vector<Case>& cases, Solve solve, int repeats) {
    std::vector<double> times, best, steps, excess;
    const std::size_t unknowns = cases.front().fit.unknown_count();
    Owned<NormalEquations> equations(unknowns);
    std::vector<float> scratch(3 * unknowns);
    for (Case& c : cases) {
      std::vector<double> ms;
      SolverReport report;
      for (int k = 0; k < repeats; ++k) {
        c.fit.start_at(c.camera, c.coefficients);
        const double start = wall_ms();
        report = solve(c.fit, *equations, scratch.data());
        ms.push_back(wall_ms() - start);
      }
      times.push_back(quantile(ms, 0.5));
      best.push_back(quantile(ms, 0));
      steps.push_back(report.iterations);
      excess.push_back(c.fit.exact_cost() / c.optimum - 1);
    }
    row(variant, "ms_median", quantile(times, 0.5));
    row(variant, "ms_best_median", quantile(best, 0.5));
    row(variant, "ms_worst_problem", quantile(times, 1));
    row(variant, "iterations_median", quantile(steps, 0.5));
    row(variant, "cost_above_optimum_median", quantile(excess, 0.5));
    row(variant, "cost_above_optimum_worst", quantile(excess, 1));
    row(variant, "required_bytes",
        static_cast<double>(equations.used_bytes() + scratch.size() * sizeof(float)));
  }

  const BenchRows row;
  std::string folder_;
  std::map<std::string, double> optimum_;
};

}  // namespace

void bench_fit(std::ostream& out, const std::string& folder) {
  FitBench bench(out, folder);
  for (int points : {80, 160}) bench.run_full(points);
  for (int points : {200, 500, 1800}) bench.run_track(points);
}

}  // namespace pliant::host
