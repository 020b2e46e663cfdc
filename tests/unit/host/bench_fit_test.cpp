// The fitting problems of `pliant bench fit`: read, solved, and refused.
#include <doctest/doctest.h>

#include <cmath>
#include <sstream>

#include "cli_run.hpp"
#include "host/bench/fit_problem.hpp"
#include "host/bench/rows.hpp"
#include "host/io/failure.hpp"
#include "host/io/owned.hpp"
#include "random.hpp"

namespace bench_fit_test {

using namespace pliant;
using namespace pliant::host;
using namespace cli_run;

namespace {

/// A problem of `points` exact observations of a curved patch with three modes, as text.
std::string problem_text(int points) {
  Random random(3);
  std::ostringstream out;
  out.precision(9);
  out << "corr " << points << " modes 3 cx 320 cy 240 sigma_px 0.5\ncamera_true 0 0 0 5 -4 600 800\n"
      << "camera_start 0.1 -0.1 0.1 20 -19 660 700\ncoef_true 0.5 -1 1.5\n# a comment\n";
  for (int i = 0; i < points; ++i) {
    const double u = random.uniform() - 0.5, v = random.uniform() - 0.5;
    const double mean[3] = {150 * u, 200 * v, 120 * (u * u + v * v)};
    const double basis[3][3] = {
        {8 * u, 0, 3 * v * v}, {0, 9 * v * u, 4}, {10 * u * u, 6 * v * v * v, 5 * u * v}};
    double p[3];
    for (int c = 0; c < 3; ++c) p[c] = mean[c] + 0.5 * basis[c][0] - basis[c][1] + 1.5 * basis[c][2];
    out << 320 + 800 * (p[0] + 5) / (p[2] + 600) << ' ' << 240 + 800 * (p[1] - 4) / (p[2] + 600);
    for (double m : mean) out << ' ' << m;
    for (const auto& row : basis)
      for (double b : row) out << ' ' << b;
    out << '\n';
  }
  return out.str();
}

double solve(LinearShapeFit& fit) {
  Owned<NormalEquations> equations(fit.unknown_count());
  std::vector<float> step(fit.unknown_count());
  SolverOptions options;
  options.max_accepted = 40;
  minimise(fit.problem(), options, *equations, step.data());
  return fit.exact_cost();
}

}  // namespace

TEST_CASE("rows of bench tell bytes to the byte") {
  std::ostringstream out;
  BenchRows(out, "track")("a", "arena_bytes", 5250112);
  BenchRows(out, "track")("a", "median_ms", 0.75);
  CHECK(out.str() == "track,pliant,a,arena_bytes,5250112\ntrack,pliant,a,median_ms,0.75\n");
}

TEST_CASE("an exact problem without prior is solved to zero cost from a rough initial state with any loss") {
  const Folder folder;
  LinearShapeFit fit(folder.put("p.txt", problem_text(60)));
  REQUIRE(fit.point_count() == 60);
  fit.set_prior(false);
  for (Loss loss : {Loss::squares, Loss::huber})
    for (bool focal_is_known : {false, true}) {
      fit.set_loss(loss);
      fit.set_focal_known(focal_is_known);
      std::vector<double> camera = fit.camera_start();
      if (focal_is_known) camera[6] = fit.camera_true()[6];
      fit.start_at(camera, {0, 0, 0});
      CHECK(fit.exact_cost() > 100);
      CHECK(solve(fit) < 1e-3);
    }
}

TEST_CASE("at the truth the cost is that of the prior") {
  const Folder folder;
  LinearShapeFit fit(folder.put("p.txt", problem_text(40)));
  fit.start_at(fit.camera_true(), fit.coefficients_true());
  CHECK(fit.exact_cost() == doctest::Approx(0.5 * (0.25 + 1 + 2.25)).epsilon(1e-3));
}

TEST_CASE("a truncated or wrong problem gives one line with the name of the file") {
  const Folder folder;
  const std::string text = problem_text(5);
  for (std::size_t cut :
       {std::size_t{0}, std::size_t{20}, std::size_t{90}, text.size() / 2, text.rfind(' ')}) {
    const std::string path = folder.put("cut.txt", text.substr(0, cut));
    try {
      LinearShapeFit fit(path);
      FAIL("read a problem cut at " << cut);
    } catch (const Failure& failure) {
      CHECK(std::string(failure.what()).find("cut.txt") != std::string::npos);
    }
  }
  check_refused({"bench", "fit", "--problems", folder / "none"}, {"solutions.csv"});
}

}  // namespace bench_fit_test
