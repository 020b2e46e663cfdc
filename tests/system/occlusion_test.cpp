// Which rejection method is better in each case of the occlusion experiment, on the built-in face (docs/algorithms.md, section
// 6.5). Beside each bound is the measured ratio of the two sides' errors. Scenes are seeded; the bounds leave room for other fits.
#include <doctest/doctest.h>

#include "baked_face.hpp"
#include "host/bench/occlusion_experiment.hpp"

namespace occlusion_test {

using namespace pliant;
using namespace pliant::host;

namespace {

double px(const OcclusionResult& r, RejectionMethod d) {
  return r.mean_px[static_cast<int>(d)];
}
double lost(const OcclusionResult& r, RejectionMethod d) {
  return r.fraction_over_3px[static_cast<int>(d)];
}
OcclusionResult measure(Disturbance disturbance, double fraction) {
  return measure_occlusion(baked_face().model, disturbance, fraction, 4, 8);
}

}  // namespace

TEST_CASE(
    "without false points forces cost accuracy, re-admission removes this cost, and on_doubt has none") {
  const OcclusionResult r = measure(Disturbance::none, 0);
  CHECK(px(r, RejectionMethod::forces) > 1.1 * px(r, RejectionMethod::weights));  // 1.14
  CHECK(px(r, RejectionMethod::forces_predicted) <
        1.03 * px(r, RejectionMethod::weights_predicted));  // 1.005
  CHECK(px(r, RejectionMethod::on_doubt) == doctest::Approx(px(r, RejectionMethod::weights_predicted)));
}

TEST_CASE("robust weights suffice against single false points") {
  const OcclusionResult r = measure(Disturbance::random, 0.35);
  CHECK(px(r, RejectionMethod::weights) < 0.3 * px(r, RejectionMethod::least_squares));               // 0.16
  CHECK(px(r, RejectionMethod::forces_predicted) < 1.1 * px(r, RejectionMethod::weights_predicted));  // 1.000
  CHECK(px(r, RejectionMethod::on_doubt) < 1.1 * px(r, RejectionMethod::weights_predicted));          // 1.000
}

TEST_CASE("with a moving occluder weights fail and rejection by forces does not") {
  const OcclusionResult r = measure(Disturbance::moving, 0.35);
  CHECK(px(r, RejectionMethod::least_squares) > px(r, RejectionMethod::weights));                   // 1.9
  CHECK(px(r, RejectionMethod::weights) > 2 * px(r, RejectionMethod::forces));                      // 3.9
  CHECK(px(r, RejectionMethod::forces) > px(r, RejectionMethod::forces_predicted));                 // 7.0
  CHECK(px(r, RejectionMethod::weights_predicted) > 3 * px(r, RejectionMethod::forces_predicted));  // 7.8
  CHECK(lost(r, RejectionMethod::forces_predicted) == 0);
  CHECK(px(r, RejectionMethod::on_doubt) < 0.5 * px(r, RejectionMethod::weights_predicted));  // 0.20
}

TEST_CASE("with an occluder at rest rejection needs forces at the predicted state") {
  const OcclusionResult r = measure(Disturbance::standing, 0.35);
  CHECK(px(r, RejectionMethod::forces) > px(r, RejectionMethod::weights));                            // 1.7
  CHECK(px(r, RejectionMethod::forces_predicted) < 0.4 * px(r, RejectionMethod::weights_predicted));  // 0.11
  CHECK(px(r, RejectionMethod::on_doubt) < 0.8 * px(r, RejectionMethod::weights_predicted));          // 0.33
}

TEST_CASE("a jaw that drops is kept by weights and rejected by forces on the rigid block") {
  const OcclusionResult r = measure(Disturbance::expression, 0);
  CHECK(px(r, RejectionMethod::forces) > 2 * px(r, RejectionMethod::weights));                 // 6.9
  CHECK(px(r, RejectionMethod::on_doubt) < 1.05 * px(r, RejectionMethod::weights_predicted));  // 1.000
}

}  // namespace occlusion_test
