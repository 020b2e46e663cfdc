// Ridge regression: a linear function is found, and sums that are not finite are said.
#include "host/learn/ridge.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <stdexcept>

#include "random.hpp"

namespace ridge_test {

using namespace pliant::host::learn;

TEST_CASE("a linear function with a constant is found, and its errors are small") {
  RidgeSums sums;
  sums.resize(3, 2);
  {
    RidgeRows rows(sums);
    Random random(3);
    for (int k = 0; k < 1000; ++k) {
      const float x[2] = {random.uniform(-1, 1), random.uniform(-1, 1)};
      const double a = static_cast<double>(x[0]), b = static_cast<double>(x[1]);
      const double y[2] = {2 * a - b + 5, 3 * b};
      rows.add(x, y, 1);
    }
  }
  const std::vector<double> w = solve_ridge(sums, 0);
  const double wanted[] = {2, -1, 5, 0, 3, 0};
  for (std::size_t k = 0; k < 6; ++k) CHECK(w[k] == doctest::Approx(wanted[k]).epsilon(1e-3));
  for (const double e : squared_errors(sums, w)) CHECK(e < 1e-2);
}

TEST_CASE("an input or an output that is not finite is said") {
  RidgeSums sums;
  sums.resize(2, 1);
  const float x[] = {1};
  const double y[] = {std::numeric_limits<double>::quiet_NaN()};
  SUBCASE("of an output") {
    RidgeRows(sums).add(x, y, 1);
  }
  SUBCASE("of an input") {
    const float bad[] = {std::numeric_limits<float>::quiet_NaN()};
    const double good[] = {1};
    RidgeRows(sums).add(bad, good, 1);
  }
  CHECK_THROWS_AS(solve_ridge(sums, 1), std::runtime_error);
}

}  // namespace ridge_test
