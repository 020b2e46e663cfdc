// The minimum covariance determinant on the classical tables: against all subsets where these can be counted,
// against the known optima, and against an independent program's results where its data are at hand
// (PLIANT_DATA). And the range of the quantiles that its cutoffs are.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>
#include <string>

#include "mcd_runner.hpp"
#include "pliant/outliers.hpp"
#include "real_data.hpp"

namespace mcd_data_test {

using namespace pliant;

namespace {

struct Best {
  std::string name;
  Table table;
  float alpha;
  double log_determinant;
  std::vector<int> flagged;
};

std::vector<Best> read_classical() {
  std::ifstream in(PLIANT_FIXTURES "/mcd/classical.txt");
  std::vector<Best> all;
  std::string line, word, name;
  Table table;
  while (std::getline(in, line)) {
    std::istringstream words(line);
    if (!(words >> word) || word[0] == '#') continue;
    if (word == "set") {
      table = {};
      words >> name >> table.columns;
    } else if (word == "best") {
      Best best;
      std::size_t columns = 0;
      words >> columns >> best.alpha >> best.log_determinant;
      for (int row; words >> row;) best.flagged.push_back(row);
      best.name = name + std::to_string(columns);
      best.table = table.first_columns(columns);
      all.push_back(best);
    } else {
      std::istringstream values(line);
      for (float v; values >> v;) table.data.push_back(v);
      table.rows = table.data.size() / table.columns;
    }
  }
  return all;
}

double binomial(std::size_t n, std::size_t k) {
  double b = 1;
  for (std::size_t i = 1; i <= k; ++i) b = b * static_cast<double>(n - k + i) / static_cast<double>(i);
  return b;
}

double least_of_all_subsets(const Table& t, std::size_t h) {
  std::vector<bool> taken(t.rows, false);
  std::fill(taken.begin(), taken.begin() + static_cast<long>(h), true);
  double least = 1e300;
  std::vector<std::size_t> rows(h);
  do {
    rows.clear();
    for (std::size_t i = 0; i < t.rows; ++i)
      if (taken[i]) rows.push_back(i);
    least = std::min(least, subset_log_determinant(t, rows));
  } while (std::prev_permutation(taken.begin(), taken.end()));
  return least;
}

McdOptions with_exchanges(float alpha) {
  McdOptions options;
  options.alpha = alpha;
  options.exchanges = 50;
  return options;
}

/// Leaves the best of ten seeds in `runner`.
double best_of_ten(McdRunner& runner, const Table& t, McdOptions options) {
  double least = 1e300;
  std::uint64_t best_seed = 1;
  for (options.seed = 1; options.seed <= 10; ++options.seed) {
    REQUIRE(runner.fast(t, options) == Status::ok);
    if (runner.log_determinant() < least - 1e-9) {
      least = runner.log_determinant();
      best_seed = options.seed;
    }
  }
  options.seed = best_seed;
  REQUIRE(runner.fast(t, options) == Status::ok);
  return runner.log_determinant();
}

/// What an independent program printed: quantity, i, j, value.
struct Reference {
  std::map<std::string, std::vector<double>> values;
  explicit Reference(const std::string& path) {
    std::ifstream in(path);
    std::string line, name, i, j, value;
    std::getline(in, line);
    while (std::getline(in, line)) {
      std::istringstream cells(line);
      std::getline(cells, name, ',');
      std::getline(cells, i, ',');
      std::getline(cells, j, ',');
      std::getline(cells, value, ',');
      values[name].push_back(std::stod(value));
    }
  }
  const std::vector<double>& operator[](const char* name) const { return values.at(name); }
};

Table read_csv(const std::string& path) {
  std::ifstream in(path);
  Table t;
  std::string line, cell;
  std::getline(in, line);
  for (; std::getline(in, line); ++t.rows) {
    std::istringstream cells(line);
    while (std::getline(cells, cell, ',')) t.data.push_back(std::stof(cell));
  }
  t.columns = t.rows == 0 ? 0 : t.data.size() / t.rows;
  return t;
}

/// Differences in units of the standard deviations that the reference gives.
double worst_difference(const McdEstimate& ours, const std::vector<double>& center,
                        const std::vector<double>& covariance) {
  const std::size_t p = center.size();
  double worst = 0;
  for (std::size_t j = 0; j < p; ++j) {
    worst = std::max(worst, std::fabs(ours.center[j] - center[j]) / std::sqrt(covariance[j * p + j]));
    for (std::size_t k = 0; k < p; ++k)
      worst = std::max(worst, std::fabs(ours.covariance[j * p + k] - covariance[j * p + k]) /
                                  std::sqrt(covariance[j * p + j] * covariance[k * p + k]));
  }
  return worst;
}

}  // namespace

TEST_CASE(
    "chi-square quantiles are exact to 1e-9 in all of their range, and values beyond it end the search, "
    "too") {
  for (const double p : {1e-12, 1e-9, 1e-6, 1e-3, 0.1, 0.9, 1 - 1e-3, 1 - 1e-6}) {
    const double exact = -2 * std::log1p(-p);  // two degrees of freedom
    CHECK(std::fabs(chi_square_quantile(2, p) - exact) < 1e-9 * exact);
    const double root = std::sqrt(0.5 * chi_square_quantile(1, p));  // the square of a normal variable
    const double ratio = p < 0.5 ? std::erf(root) / p : std::erfc(root) / (1 - p);
    CHECK(std::fabs(ratio - 1) < 1e-8);  // in a tail the probability is off by more than the quantile
  }
  for (const double p : {std::numeric_limits<double>::quiet_NaN(), -1.0, 0.0, 1e-300, 1e-18, 1.0, 2.0})
    for (const std::size_t freedom : {1u, 5u, 26u}) CHECK(chi_square_quantile(freedom, p) < 401);
}

TEST_CASE("FAST-MCD finds the smallest of all subsets, where all can be counted") {
  int counted = 0;
  for (const Best& best : read_classical()) {
    const std::size_t h =
        mcd_subset_size(best.table.rows, best.table.columns, static_cast<double>(best.alpha));
    if (binomial(best.table.rows, h) > 8e4) continue;
    ++counted;
    CAPTURE(best.name);
    CAPTURE(best.alpha);
    McdRunner runner(best.table);
    const double least = least_of_all_subsets(best.table, h);
    REQUIRE(runner.fast(best.table, with_exchanges(best.alpha)) == Status::ok);
    CHECK(runner.mcd.best_subset().count == h);
    CHECK(std::fabs(runner.log_determinant() - least) < 1e-6);
    CHECK(std::fabs(best.log_determinant - least) < 1e-4);
  }
  CHECK(counted >= 10);
}

TEST_CASE("the classical tables: the least determinant known, and the cases flagged") {
  int sets = 0;
  for (const Best& best : read_classical()) {
    ++sets;
    CAPTURE(best.name);
    CAPTURE(best.alpha);
    McdRunner runner(best.table);
    CHECK(std::fabs(best_of_ten(runner, best.table, with_exchanges(best.alpha)) - best.log_determinant) <
          1e-4);
    CHECK(runner.flagged() == best.flagged);
    std::vector<std::size_t> rows(runner.mcd.best_subset().begin(), runner.mcd.best_subset().end());
    CHECK(std::fabs(subset_log_determinant(best.table, rows) - runner.log_determinant()) < 1e-6);
  }
  CHECK(sets == 26);
}

TEST_CASE("the raw estimate flags the rows that lie beyond the cutoff from its own centre") {
  const double cutoff = -2 * std::log(0.025);  // chi-square of two degrees of freedom, 0.975
  int flagged = 0, differ = 0;
  for (const Best& best : read_classical()) {
    if (best.table.columns != 2) continue;
    CAPTURE(best.name);
    McdRunner runner(best.table);
    REQUIRE(runner.fast(best.table, with_exchanges(best.alpha)) == Status::ok);
    const McdEstimate& raw = runner.mcd.raw();
    const double xx = raw.covariance[0], xy = raw.covariance[1], yy = raw.covariance[3];
    for (std::size_t i = 0; i < best.table.rows; ++i) {
      const double x = static_cast<double>(best.table.at(i, 0)) - raw.center[0],
                   y = static_cast<double>(best.table.at(i, 1)) - raw.center[1];
      const double squared = (yy * x * x - 2 * xy * x * y + xx * y * y) / (xx * yy - xy * xy);
      REQUIRE(std::fabs(squared / cutoff - 1) > 1e-4);  // on neither side by rounding
      CHECK(runner.mcd.is_flagged_raw(i) == (squared > cutoff));
      flagged += squared > cutoff ? 1 : 0;
      differ += runner.mcd.is_flagged_raw(i) != runner.mcd.is_flagged(i) ? 1 : 0;
    }
  }
  CHECK(flagged > 0);
  CHECK(differ > 0);  // the reweighted estimate's flags would not pass for them
}

TEST_CASE("an independent program's results, every data set") {
  const char* folder = require_data();
  if (folder == nullptr) return;
  const std::string data = std::string(folder) + "/mcd/";
  std::map<std::string, double> proven;
  std::ifstream exact(data + "exact.csv"), summary(data + "summary.csv");
  std::string line, cell;
  std::getline(exact, line);
  while (std::getline(exact, line)) {
    std::istringstream cells(line);
    std::vector<std::string> c;
    while (std::getline(cells, cell, ',')) c.push_back(cell);
    proven[c[0] + "_alpha" + c[3]] = std::stod(c[6]);
  }
  CHECK(proven.size() == 20);
  int sets = 0, agreed = 0;
  std::getline(summary, line);
  for (; std::getline(summary, line); ++sets) {
    std::istringstream cells(line);
    std::vector<std::string> c;
    while (std::getline(cells, cell, ',')) c.push_back(cell);
    const std::string name = c[0] + "_alpha" + c[3];
    CAPTURE(name);
    const Table t = read_csv(data + c[0] + ".csv");
    const Reference reference(data + name + ".csv");
    const double least = reference["log_det_objective"][0], after_500 = std::stod(c[6]);
    McdOptions options = with_exchanges(std::stof(c[3]));
    McdRunner runner(t);
    std::string gaps;
    for (std::uint32_t exchanges : {0u, 50u})
      for (McdStarts starts : {McdStarts::median_ball, McdStarts::all_six}) {
        options.exchanges = exchanges;
        REQUIRE(runner.deterministic(t, starts, options) == Status::ok);
        gaps += " " + std::to_string(runner.log_determinant() - least);
      }
    const double found = best_of_ten(runner, t, options);
    MESSAGE(name, ": best of ten ", found - least, "; DetMCD one start, six, and both with exchanges:", gaps);
    if (proven.count(name) != 0) CHECK(std::fabs(found - proven[name]) < 1e-4);
    CHECK(found < after_500 + 1e-4);
    if (std::fabs(found - least) > 1e-4) continue;
    ++agreed;
    std::vector<int> flagged;
    std::istringstream rows(c[8]);
    for (int row; rows >> row;) flagged.push_back(row);
    CHECK(runner.flagged() == flagged);
    CHECK(static_cast<double>(runner.mcd.best_subset().count) == reference["h"][0]);
    CHECK(worst_difference(runner.mcd.raw(), reference["raw_center"], reference["raw_cov"]) < 1e-4);
    CHECK(worst_difference(runner.mcd.reweighted(), reference["rew_center"], reference["rew_cov"]) < 1e-4);
    const auto& raw = reference["raw_factors_consistency_smallsample"];
    const auto& reweighted = reference["rew_factors_consistency_smallsample"];
    CHECK(std::fabs(runner.mcd.raw_correction() / (raw[0] * raw[1]) - 1) < 1e-8);
    CHECK(std::fabs(runner.mcd.reweighted_correction() / (reweighted[0] * reweighted[1]) - 1) < 1e-8);
    for (std::size_t i = 0; i < t.rows; ++i) {
      const double expected = reference["rew_mah2"][i];
      CHECK(std::fabs(static_cast<double>(runner.mcd.squared_distances()[i]) - expected) <
            1e-3 * expected + 1e-3);
    }
  }
  CHECK(sets == 38);
  CHECK(agreed >= 36);
}

}  // namespace mcd_data_test
