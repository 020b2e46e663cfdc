#include "host/learn/detector_calibration.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "host/learn/sample_random.hpp"

namespace detector_calibration_test {

using namespace pliant;
using namespace pliant::host::learn;

TEST_CASE("the calibration recovers the logistic law that decided which sums were faces") {
  SampleRandom random(1, 1);
  std::vector<WeightedSum> faces, others;
  for (int k = 0; k < 20000; ++k) {
    const double sum = static_cast<double>(random.between(-200, 400)),
                 p = 1 / (1 + std::exp(-(0.02 * sum - 2)));
    (random.chance(static_cast<float>(p)) ? faces : others).push_back({sum, 1});
  }
  const Calibration c = fit_calibration(faces, others);
  CHECK(c.slope == doctest::Approx(0.02).epsilon(0.05));
  CHECK(c.offset == doctest::Approx(-2).epsilon(0.05));
}

TEST_CASE("sums that a threshold separates give a finite calibration") {
  const Calibration c = fit_calibration({{100, 1}, {120, 1}}, {{10, 1}});
  CHECK(std::isfinite(c.slope));
  CHECK(c.probability(110) > 0.8);
  CHECK(c.probability(0) < 0.2);
}

TEST_CASE("the knots ascend from the least sum on, whatever the calibration") {
  for (const Calibration c :
       {Calibration{0.01, -1}, Calibration{1e-5, 9}, Calibration{5, -500}, Calibration{}})
    for (const int least : {-40000, -10, 0, 300, 40000}) {
      DetectorHeader header{};
      set_knots(c, least, &header);
      for (int k = 1; k < kScoreKnots; ++k) {
        CHECK(header.knot_sum[k] > header.knot_sum[k - 1]);
        CHECK(header.knot_probability[k] >= header.knot_probability[k - 1]);
      }
    }
}

TEST_CASE("a tenth of many pictures calibrates, and none of few") {
  int count = 0;
  for (std::size_t k = 0; k < 100; ++k) count += calibrates(k, 100) ? 1 : 0;
  CHECK(count == 10);
  for (std::size_t k = 0; k < kFewPictures - 1; ++k) CHECK(!calibrates(k, kFewPictures - 1));
}

}  // namespace detector_calibration_test
