// Minimum covariance determinant: its tables of numbers, its invariances, and everything that data can do wrong.
#include "pliant/outliers.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>

#include "aligned_block.hpp"
#include "base/elementary.hpp"
#include "mcd_runner.hpp"
#include "random.hpp"

namespace outliers_test {
using namespace pliant;

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

Table gaussian(std::size_t rows, std::size_t columns, std::uint64_t seed) {
  Random random(seed);
  Table t{rows, columns, {}};
  for (std::size_t i = 0; i < rows * columns; ++i) t.data.push_back(random.normal());
  return t;
}

/// Gaussian, but the first `bad` rows shifted by `shift` in every column and `spread` wide.
Table contaminated(std::size_t rows, std::size_t columns, std::size_t bad, float shift, float spread,
                   std::uint64_t seed) {
  Table t = gaussian(rows, columns, seed);
  for (std::size_t i = 0; i < bad * columns; ++i) t.data[i] = shift + spread * t.data[i];
  return t;
}

std::size_t flagged_among(const Mcd& mcd, std::size_t first, std::size_t last) {
  std::size_t count = 0;
  for (std::size_t i = first; i < last; ++i) count += mcd.is_flagged(i) ? 1 : 0;
  return count;
}

void check_finite(const Mcd& mcd) {
  for (const McdEstimate* estimate : {&mcd.raw(), &mcd.reweighted()})
    for (std::size_t j = 0; j < mcd.columns(); ++j) {
      CHECK(std::isfinite(estimate->center[j]));
      CHECK(estimate->covariance[j * mcd.columns() + j] >= 0);
      for (std::size_t k = 0; k < mcd.columns(); ++k) {
        CHECK(std::isfinite(estimate->covariance[j * mcd.columns() + k]));
        CHECK(estimate->covariance[j * mcd.columns() + k] == estimate->covariance[k * mcd.columns() + j]);
      }
    }
  for (std::size_t i = 0; i < mcd.rows(); ++i) {
    CHECK((mcd.squared_distances()[i] >= 0 && mcd.squared_distances()[i] <= kMcdOffSubspace));
    CHECK((mcd.raw_squared_distances()[i] >= 0 && mcd.raw_squared_distances()[i] <= kMcdOffSubspace));
  }
  CHECK((mcd.determinant().mantissa >= 0.5 && mcd.determinant().mantissa < 1.0));
}

/// Both searches, and both kinds of deterministic starts, on the same table.
template <class Check>
void with_every_search(const Table& t, const McdOptions& options, Check check) {
  for (int kind = 0; kind < 3; ++kind) {
    CAPTURE(kind);
    McdRunner runner(t);
    if (kind == 0) (void)runner.fast(t, options);
    if (kind == 1) (void)runner.deterministic(t, McdStarts::median_ball, options);
    if (kind == 2) (void)runner.deterministic(t, McdStarts::all_six, options);
    check_finite(runner.mcd);
    check(runner);
  }
}

McdOptions with_alpha(float alpha) {
  McdOptions options;
  options.alpha = alpha;
  return options;
}

}  // namespace

TEST_CASE("chi-square quantiles are those of the tables") {
  struct Row {
    std::size_t p;
    double q50, q975, q99, q999;
  };
  for (const Row& r :
       {Row{1, 0.454936, 5.023886, 6.634897, 10.827566}, Row{2, 1.3863, 7.3778, 9.2103, 13.8155},
        Row{3, 2.3660, 9.3484, 11.3449, 16.2662}, Row{4, 3.3567, 11.1433, 13.2767, 18.4668},
        Row{6, 5.3481, 14.4494, 16.8119, 22.4577}, Row{7, 6.3458, 16.0128, 18.4753, 24.3219},
        Row{11, 10.3410, 21.9200, 24.7250, 31.2641}, Row{16, 15.3385, 28.8454, 31.9999, 39.2524},
        Row{24, 23.3367, 39.3641, 42.9798, 51.1786}}) {
    CHECK(std::fabs(chi_square_quantile(r.p, 0.5) - r.q50) < 6e-5);
    CHECK(std::fabs(chi_square_quantile(r.p, 0.975) - r.q975) < 6e-5);
    CHECK(std::fabs(chi_square_quantile(r.p, 0.99) - r.q99) < 6e-5);
    CHECK(std::fabs(chi_square_quantile(r.p, 0.999) - r.q999) < 6e-5);
  }
  for (double x : {1e-6, 0.01, 0.7, 3.0, 20.0, 90.0})  // two degrees of freedom have a closed form
    CHECK(std::fabs(chi_square_probability(2, x) - (1 - std::exp(-x / 2))) < 1e-13);
  for (std::size_t p = 1; p <= 26; ++p)
    for (double q : {1e-4, 0.01, 0.5, 0.9, 0.9999})
      CHECK(std::fabs(chi_square_probability(p, chi_square_quantile(p, q)) - q) < 1e-12);
}

TEST_CASE("consistency and small-sample factors are those of the literature") {
  struct Row {
    std::size_t p;
    double half, quarters, most;
  };
  for (const Row& r : {Row{2, 3.25889, 1.85908, 1.10447}, Row{3, 2.45737, 1.60918, 1.07848},
                       Row{4, 2.10906, 1.48642, 1.06447}, Row{5, 1.91221, 1.41207, 1.05553},
                       Row{6, 1.78446, 1.36159, 1.04927}, Row{8, 1.62658, 1.29647, 1.04093},
                       Row{11, 1.49629, 1.24019, 1.03351}, Row{16, 1.38354, 1.18943, 1.02664},
                       Row{24, 1.29478, 1.14801, 1.02093}}) {
    CHECK(std::fabs(mcd_consistency_factor(r.p, 0.5) - r.half) < 6e-6);
    CHECK(std::fabs(mcd_consistency_factor(r.p, 0.75) - r.quarters) < 6e-6);
    CHECK(std::fabs(mcd_consistency_factor(r.p, 0.975) - r.most) < 6e-6);
  }
  struct Small {
    std::size_t p;
    double raw[3], reweighted[3];
  };
  for (const Small& s : {Small{2, {1.0884, 1.0530, 1.0274}, {1.0033, 1.0009, 1.0002}},
                         Small{6, {1.1268, 1.0667, 1.0296}, {1.0279, 1.0073, 1.0012}},
                         Small{11, {1.1785, 1.0892, 1.0377}, {1.0707, 1.0249, 1.0065}},
                         Small{24, {1.3438, 1.1541, 1.0599}, {1.0397, 1.0219, 1.0101}}}) {
    const std::size_t rows[] = {100, 200, 500};
    for (int k = 0; k < 3; ++k) {
      CHECK(std::fabs(mcd_small_sample_raw(rows[k], s.p, 0.5) - s.raw[k]) < 6e-5);
      CHECK(std::fabs(mcd_small_sample_reweighted(rows[k], s.p, 0.5) - s.reweighted[k]) < 6e-5);
    }
  }
  for (std::size_t p : {1u, 2u, 5u, 24u}) {
    CHECK(mcd_consistency_factor(p, 1) == 1);
    CHECK(std::fabs(mcd_small_sample_raw(100, p, 1) - 1) < 1e-12);
    CHECK(mcd_small_sample_raw(100, p, 0.5) > mcd_small_sample_raw(100, p, 0.9));
  }
}

TEST_CASE("the subset's size runs from half of the rows to all of them") {
  CHECK(mcd_subset_size(75, 3, 0.5) == 39);
  CHECK(mcd_subset_size(75, 3, 0.75) == 57);
  CHECK(mcd_subset_size(20, 6, 0.5) == 13);
  CHECK(mcd_subset_size(500, 20, 0.75) == 380);
  for (std::size_t n = 3; n < 60; ++n)
    for (std::size_t p = 1; p + 1 < n && p <= 24; ++p) {
      CHECK(mcd_subset_size(n, p, 0.5) == (n + p + 1) / 2);
      CHECK(mcd_subset_size(n, p, 1) == n);
      CHECK(mcd_subset_size(n, p, 0.7) >= mcd_subset_size(n, p, 0.6));
    }
}

TEST_CASE("elementary functions without libm") {
  CHECK(square_root(2.0) == std::sqrt(2.0));
  CHECK(square_root(-1e-300) == 0);
  CHECK(std::isnan(square_root(std::nan(""))));
  for (double x = 1e-12; x < 1e12; x *= 1.7) CHECK(std::fabs(natural_log(x) - std::log(x)) < 1e-13);
  for (double x = -650; x < 650; x += 1.3) CHECK(std::fabs(exponential(x) / std::exp(x) - 1) < 2e-13);
  for (float x = -9; x < 9; x += 0.013f) CHECK(std::fabs(hyperbolic_tangent(x) - std::tanh(x)) < 2e-4f);
  for (double x = -4.5; x < 4.5; x += 0.01)
    CHECK(std::fabs(normal_quantile(0.5 * std::erfc(-x / std::sqrt(2.0))) - x) < 4.6e-4);
}

TEST_CASE("both estimates of clean Gaussian data are consistent, and few rows are flagged") {
  const Table t = gaussian(4000, 4, 1);
  for (float alpha : {0.5f, 0.75f, 1.0f})
    with_every_search(t, with_alpha(alpha), [&](const McdRunner& r) {
      CHECK(r.status == Status::ok);
      for (const McdEstimate* e : {&r.mcd.raw(), &r.mcd.reweighted()})
        for (std::size_t j = 0; j < 4; ++j) {
          CHECK(std::fabs(e->center[j]) < 0.12);
          for (std::size_t k = 0; k < 4; ++k)
            CHECK(std::fabs(e->covariance[j * 4 + k] - (j == k ? 1 : 0)) < 0.15);
        }
      const std::size_t flagged = flagged_among(r.mcd, 0, t.rows);
      CHECK((flagged > 50 && flagged < 160));  // 100 expected; the tails of `Random` are a little short
    });
}

TEST_CASE("a cluster of outliers is flagged whole, up to four rows in ten") {
  for (std::size_t p : {1u, 2u, 4u, 6u})
    for (std::size_t percent : {0u, 10u, 25u, 40u}) {
      CAPTURE(p);
      CAPTURE(percent);
      const std::size_t bad = 200 * percent / 100;
      with_every_search(contaminated(200, p, bad, 15.0f, 1.0f, 31 + p), {}, [&](const McdRunner& r) {
        CHECK(r.status == Status::ok);
        CHECK(flagged_among(r.mcd, 0, bad) == bad);
        CHECK(flagged_among(r.mcd, bad, 200) < 24);
      });
    }
}

TEST_CASE("alpha 0.75 stands a fifth of the rows, and at 1 the raw estimate is mean and covariance") {
  const Table t = contaminated(300, 5, 60, 12.0f, 0.3f, 5);
  with_every_search(t, with_alpha(0.75f),
                    [&](const McdRunner& r) { CHECK(flagged_among(r.mcd, 0, 60) == 60); });
  const Table clean = gaussian(100, 3, 9);
  with_every_search(clean, with_alpha(1), [&](const McdRunner& r) {
    CHECK(r.mcd.best_subset().count == 100);
    double mean = 0, square = 0;
    for (std::size_t i = 0; i < 100; ++i) mean += static_cast<double>(clean.at(i, 1)) / 100;
    for (std::size_t i = 0; i < 100; ++i)
      square += std::pow(static_cast<double>(clean.at(i, 1)) - mean, 2) / 99;
    CHECK(std::fabs(r.mcd.raw().center[1] - mean) < 1e-6);
    CHECK(std::fabs(r.mcd.raw().covariance[4] - square) < 1e-6);
  });
}

TEST_CASE("affine maps of the data map the estimate and change neither subset nor flags") {
  const Table t = contaminated(150, 3, 40, 8.0f, 0.5f, 77);
  const float a[3][3] = {{3.0f, -1.0f, 0.5f}, {200.0f, 100.0f, 0.0f}, {0.001f, 0.002f, -0.004f}},
              b[3] = {10, -400, 0.5f};
  Table mapped{t.rows, 3, {}};
  for (std::size_t i = 0; i < t.rows; ++i)
    for (int j = 0; j < 3; ++j)
      mapped.data.push_back(a[j][0] * t.at(i, 0) + a[j][1] * t.at(i, 1) + a[j][2] * t.at(i, 2) + b[j]);
  McdOptions options;
  options.exchanges = 50;
  McdRunner one(t), two(mapped);
  REQUIRE(one.fast(t, options) == Status::ok);
  REQUIRE(two.fast(mapped, options) == Status::ok);
  REQUIRE(one.mcd.best_subset().count == two.mcd.best_subset().count);
  CHECK(
      std::equal(one.mcd.best_subset().begin(), one.mcd.best_subset().end(), two.mcd.best_subset().begin()));
  CHECK(one.flagged() == two.flagged());
  const double det = 3.0 * (100.0 * -0.004) + 200.0 * -0.004 + 0.5 * (200.0 * 0.002 - 100.0 * 0.001);
  CHECK(std::fabs(two.log_determinant() - one.log_determinant() - 2 * std::log(std::fabs(det))) < 1e-3);
  for (std::size_t i = 0; i < t.rows; ++i)
    CHECK(std::fabs(two.mcd.squared_distances()[i] / one.mcd.squared_distances()[i] - 1) < 1e-3f);
  for (std::size_t j = 0; j < 3; ++j) {
    double expected = static_cast<double>(b[j]);
    for (std::size_t k = 0; k < 3; ++k)
      expected += static_cast<double>(a[j][k]) * one.mcd.reweighted().center[k];
    const double sd = std::sqrt(two.mcd.reweighted().covariance[j * 4]);
    CHECK(std::fabs(two.mcd.reweighted().center[j] - expected) < 1e-4 * sd);
  }
}

TEST_CASE("DetMCD does not depend on the order of the rows") {
  const Table t = contaminated(211, 4, 60, 6.0f, 2.0f, 3);
  Table reversed = t;
  for (std::size_t i = 0; i < t.rows; ++i)
    for (std::size_t j = 0; j < 4; ++j) reversed.data[i * 4 + j] = t.at(t.rows - 1 - i, j);
  for (McdStarts starts : {McdStarts::median_ball, McdStarts::all_six}) {
    McdRunner one(t), two(reversed);
    REQUIRE(one.deterministic(t, starts) == Status::ok);
    CHECK(one.mcd.full_steps() > 0);
    REQUIRE(two.deterministic(reversed, starts) == Status::ok);
    CHECK(std::fabs(one.log_determinant() - two.log_determinant()) < 1e-6);
    for (std::size_t i = 0; i < t.rows; ++i)
      CHECK(one.mcd.is_flagged(i) == two.mcd.is_flagged(t.rows - 1 - i));
  }
}

TEST_CASE("equal seeds give equal bits, in a used object too; results stay near for other seeds") {
  const Table t = contaminated(900, 5, 200, 5.0f, 1.0f, 12);
  McdRunner one(t), two(McdLimits{1000, 7});
  (void)two.fast(gaussian(640, 7, 4));
  (void)two.deterministic(gaussian(31, 2, 4), McdStarts::all_six);
  McdOptions options;
  options.seed = 5;
  REQUIRE(one.fast(t, options) == Status::ok);
  REQUIRE(two.fast(t, options) == Status::ok);
  const std::size_t bytes = t.rows * sizeof(float);
  CHECK(std::memcmp(one.mcd.squared_distances().data, two.mcd.squared_distances().data, bytes) == 0);
  CHECK(std::memcmp(&one.mcd.raw(), &two.mcd.raw(), sizeof(McdEstimate)) == 0);
  CHECK(one.mcd.determinant().mantissa == two.mcd.determinant().mantissa);
  options.seed = 6;
  REQUIRE(two.fast(t, options) == Status::ok);
  CHECK(std::fabs(one.log_determinant() - two.log_determinant()) < 0.05);
}

TEST_CASE("the same bits on every compiler, level and target") {
  std::uint64_t digest = 1469598103934665603ull;
  const auto add = [&](const void* data, std::size_t bytes) {  // FNV-1a
    for (std::size_t i = 0; i < bytes; ++i)
      digest = (digest ^ static_cast<const unsigned char*>(data)[i]) * 1099511628211ull;
  };
  McdOptions options;
  options.starts = 60;
  options.exchanges = 10;
  for (std::size_t p : {1u, 2u, 5u, 12u})
    with_every_search(contaminated(130 * p, p, 20 * p, 4.0f, 1.0f, p), options, [&](const McdRunner& r) {
      add(r.mcd.squared_distances().data, r.mcd.rows() * sizeof(float));
      add(r.mcd.raw_squared_distances().data, r.mcd.rows() * sizeof(float));
      add(&r.mcd.reweighted(), sizeof(McdEstimate));
    });
  CHECK(digest == 0xfecc30f184b0bdcaull);
}

TEST_CASE("the subset is a fixed point of the C-step, and exchanges never raise the determinant") {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const Table t = contaminated(60, 3, 15, 3.0f, 1.0f, seed);
    McdRunner plain(t), more(t);
    McdOptions options;
    REQUIRE(plain.deterministic(t, McdStarts::median_ball, options) == Status::ok);
    options.exchanges = 200;
    REQUIRE(more.deterministic(t, McdStarts::median_ball, options) == Status::ok);
    CHECK(more.log_determinant() < plain.log_determinant() + 1e-9);
    const Span<const float> d = plain.mcd.raw_squared_distances();
    float largest_inside = 0, smallest_outside = 1e30f;
    std::vector<bool> inside(t.rows, false);
    for (std::uint16_t row : plain.mcd.best_subset()) inside[row] = true;
    for (std::size_t i = 0; i < t.rows; ++i) {
      if (inside[i])
        largest_inside = std::max(largest_inside, d[i]);
      else
        smallest_outside = std::min(smallest_outside, d[i]);
    }
    CHECK(largest_inside <= smallest_outside);
  }
}

TEST_CASE("after exchanges no exchange of two rows lowers the determinant") {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Table t = contaminated(40, 2, 12, 3.0f, 1.0f, 100 + seed);
    McdRunner runner(t);
    McdOptions options;
    options.exchanges = 500;
    REQUIRE(runner.deterministic(t, McdStarts::median_ball, options) == Status::ok);
    std::vector<std::size_t> rows(runner.mcd.best_subset().begin(), runner.mcd.best_subset().end());
    CHECK(std::is_sorted(rows.begin(), rows.end()));
    const double least = subset_log_determinant(t, rows);
    CHECK(std::fabs(least - runner.log_determinant()) < 1e-6);
    for (std::size_t k = 0; k < rows.size(); ++k)
      for (std::size_t i = 0; i < t.rows; ++i) {
        if (std::find(rows.begin(), rows.end(), i) != rows.end()) continue;
        std::vector<std::size_t> other = rows;
        other[k] = i;
        CHECK(subset_log_determinant(t, other) > least - 1e-6);
      }
  }
}

TEST_CASE("rows with NaN or infinity are flagged and change nothing else") {
  const Table t = contaminated(120, 3, 30, 9.0f, 1.0f, 8);
  Table holes{t.rows + 3, 3, {}};
  const float bad[3][3] = {{kNan, 0, 0}, {0, kInfinity, 0}, {0, 1, -kInfinity}};
  for (std::size_t i = 0; i < holes.rows; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      holes.data.push_back(i % 40 == 39 && i < 120 ? bad[i / 40][j]
                                                   : t.at(i - std::min<std::size_t>((i + 1) / 40, 3), j));
  with_every_search(holes, {}, [&](const McdRunner& r) {
    CHECK(r.status == Status::ok);
    for (std::size_t i : {39u, 79u, 119u}) {
      CHECK((r.mcd.is_flagged(i) && r.mcd.is_flagged_raw(i)));
      CHECK(r.mcd.squared_distances()[i] == kMcdOffSubspace);
    }
  });
  McdRunner with(holes), without(t);
  REQUIRE(with.fast(holes) == Status::ok);
  REQUIRE(without.fast(t) == Status::ok);
  CHECK(std::memcmp(&with.mcd.reweighted(), &without.mcd.reweighted(), sizeof(McdEstimate)) == 0);
}

TEST_CASE("too few rows: a status, medians, nothing finite flagged") {
  for (std::size_t n : {0u, 1u, 3u, 4u}) {
    Table t = gaussian(n, 3, 2);
    t.rows = n + 1;  // and one row that is not finite
    for (int j = 0; j < 3; ++j) t.data.push_back(kNan);
    with_every_search(t, {}, [&](const McdRunner& r) {
      CHECK(r.status == Status::too_few_points);
      CHECK(flagged_among(r.mcd, 0, n) == 0);
      CHECK(r.mcd.is_flagged(n));
      if (n == 3)
        CHECK(r.mcd.reweighted().center[0] == doctest::Approx(static_cast<double>(std::max(
                                                  std::min(t.at(0, 0), t.at(1, 0)),
                                                  std::min(std::max(t.at(0, 0), t.at(1, 0)), t.at(2, 0))))));
    });
  }
  with_every_search(gaussian(5, 3, 2), {}, [](const McdRunner& r) { CHECK(r.status == Status::ok); });
}

TEST_CASE("a column constant in most rows: the rest is estimated, rows that differ there are flagged") {
  Table t = gaussian(100, 3, 21);
  for (std::size_t i = 0; i < 100; ++i) t.data[i * 3 + 1] = i % 4 == 0 ? t.at(i, 1) : 2.5f;
  with_every_search(t, {}, [](const McdRunner& r) {
    CHECK(r.status == Status::degenerate_data);
    CHECK(r.mcd.reweighted().center[1] == 2.5);
    CHECK(r.mcd.reweighted().covariance[4] == 0);
    CHECK((r.mcd.reweighted().covariance[0] > 0.4 && r.mcd.reweighted().covariance[0] < 2));
    for (std::size_t i = 0; i < 100; ++i) CHECK((i % 4 != 0 || r.mcd.is_flagged(i)));
    CHECK(r.flagged().size() < 36);
  });
  const Table points = gaussian(100, 3, 22);
  McdOptions most = with_alpha(0.9f);  // 75 equal values are no majority of 0.9
  with_every_search(t, most, [](const McdRunner& r) { CHECK(r.status == Status::ok); });
}

TEST_CASE("all rows equal, and all but a few: the point is the answer") {
  Table t{50, 4, std::vector<float>(200, -3.0f)};
  with_every_search(t, {}, [](const McdRunner& r) {
    CHECK(r.status == Status::degenerate_data);
    CHECK(r.flagged().empty());
    CHECK(r.mcd.raw().center[2] == -3.0);
    CHECK(r.mcd.raw().covariance[0] == 0);
  });
  for (std::size_t i = 0; i < 12; ++i) t.data[i] = static_cast<float>(i);  // rows 1 to 3
  with_every_search(t, {}, [](const McdRunner& r) {
    CHECK(r.status == Status::degenerate_data);
    CHECK(r.flagged() == std::vector<int>{1, 2, 3});
  });
}

TEST_CASE("most rows in an oblique plane: the plane is found and rows off it are flagged") {
  Table t = gaussian(120, 3, 41);
  for (std::size_t i = 30; i < 120; ++i) t.data[i * 3 + 2] = 0.5f * t.at(i, 0) - 0.25f * t.at(i, 1) + 1;
  with_every_search(t, {}, [](const McdRunner& r) {
    CHECK(r.status == Status::degenerate_data);
    CHECK(flagged_among(r.mcd, 0, 30) == 30);
    CHECK(flagged_among(r.mcd, 30, 120) < 15);
  });
}

TEST_CASE("nearly collinear columns are no degeneracy") {
  Table t = contaminated(200, 3, 40, 10.0f, 1.0f, 51);
  for (std::size_t i = 0; i < 200; ++i) t.data[i * 3 + 2] = t.at(i, 0) + t.at(i, 1) + 1e-3f * t.at(i, 2);
  with_every_search(t, {}, [](const McdRunner& r) {
    CHECK(r.status == Status::ok);
    CHECK(flagged_among(r.mcd, 0, 40) == 40);
    CHECK(flagged_among(r.mcd, 40, 200) < 20);
  });
}

TEST_CASE("huge, tiny and coarse values stay finite") {
  for (float unit : {1e-35f, 1e-20f, 1e20f, 3e37f}) {
    CAPTURE(unit);
    Table t = contaminated(80, 2, 20, 6.0f, 0.5f, 6);
    for (float& v : t.data) v *= unit;
    with_every_search(t, {}, [](const McdRunner& r) {
      CHECK(r.status == Status::ok);
      CHECK(flagged_among(r.mcd, 0, 20) == 20);
    });
  }
  Table mixed = gaussian(60, 2, 7);
  for (std::size_t i = 0; i < 20; ++i) mixed.data[i] = i % 2 == 0 ? 3e38f : -3e38f;
  with_every_search(mixed, {}, [](const McdRunner& r) { CHECK(flagged_among(r.mcd, 0, 10) == 10); });
  Random random(3);
  for (int trial = 0; trial < 60; ++trial) {  // grids: ties, repeated rows, planes by chance
    Table grid{
        static_cast<std::size_t>(3 + random.below(40)), static_cast<std::size_t>(1 + random.below(6)), {}};
    const int levels = 1 + random.below(4);
    for (std::size_t i = 0; i < grid.rows * grid.columns; ++i)
      grid.data.push_back(static_cast<float>(random.below(levels)));
    McdOptions options = with_alpha(random.uniform(0.5f, 1));
    options.starts = 40;
    options.exchanges = 20;
    with_every_search(grid, options, [](const McdRunner&) {});
  }
}

TEST_CASE("bad arguments and data beyond the limits leave the results as they were") {
  const Table t = gaussian(50, 3, 2);
  McdRunner r(t);
  REQUIRE(r.fast(t) == Status::ok);
  const McdEstimate before = r.mcd.raw();
  CHECK(r.mcd.fast(nullptr, 50, 3) == Status::bad_argument);
  CHECK(r.mcd.fast(t.data.data(), 50, 0) == Status::bad_argument);
  CHECK(r.mcd.fast(t.data.data(), 51, 2) == Status::capacity);
  CHECK(r.mcd.deterministic(t.data.data(), 10, 4, McdStarts::all_six) == Status::capacity);
  for (float alpha : {0.49f, 1.01f, kNan}) CHECK(r.fast(t, with_alpha(alpha)) == Status::bad_argument);
  McdOptions options;
  for (float cutoff : {0.0f, 1.0f, kNan}) {
    options.cutoff = cutoff;
    CHECK(r.deterministic(t, McdStarts::median_ball, options) == Status::bad_argument);
  }
  options = {};
  options.starts = 0;
  CHECK(r.fast(t, options) == Status::bad_argument);
  CHECK(std::memcmp(&before, &r.mcd.raw(), sizeof before) == 0);
  CHECK(r.mcd.rows() == 50);
}

TEST_CASE("every smaller block fails cleanly, and the largest data fit their limits") {
  const McdLimits limits{40, 3};
  const std::size_t need = measured_bytes<Mcd>(limits);
  AlignedBlock block(need);
  for (std::size_t bytes = 0; bytes < need; bytes += 61) {
    Arena arena(block.data(), bytes);
    Mcd mcd;
    CHECK(create_in(arena, mcd, limits) == Status::out_of_memory);
    const float values[5] = {};
    CHECK(mcd.fast(values, 5, 1) == Status::capacity);
  }
  const Table large = contaminated(4096, 24, 800, 10.0f, 1.0f, 5);
  McdRunner runner(large);
  McdOptions options;
  options.starts = 50;
  REQUIRE(runner.fast(large, options) == Status::ok);
  CHECK(flagged_among(runner.mcd, 0, 800) == 800);
  REQUIRE(runner.deterministic(large) == Status::ok);
  CHECK(flagged_among(runner.mcd, 0, 800) == 800);
  MESSAGE("bytes at 4096 x 24: ", measured_bytes<Mcd>(McdLimits{4096, 24}),
          ", at 256 x 6: ", measured_bytes<Mcd>(McdLimits{256, 6}));
}

}  // namespace outliers_test
