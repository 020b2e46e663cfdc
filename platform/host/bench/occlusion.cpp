// `pliant bench occlusion`: the occlusion experiment with the estimator and each rejection method (docs/algorithms.md,
// section 6.5).
#include "host/bench/bench.hpp"
#include "host/bench/occlusion_experiment.hpp"
#include "host/bench/rows.hpp"

namespace pliant::host {

void bench_occlusion(std::ostream& out, const ModelFile& model) {
  struct Case {
    const char* name;
    Disturbance disturbance;
    double fraction;
  };
  constexpr Case kCases[] = {{"none", Disturbance::none, 0},
                             {"random_20", Disturbance::random, 0.20},
                             {"random_35", Disturbance::random, 0.35},
                             {"moving_20", Disturbance::moving, 0.20},
                             {"moving_35", Disturbance::moving, 0.35},
                             {"standing_20", Disturbance::standing, 0.20},
                             {"standing_35", Disturbance::standing, 0.35},
                             {"jaw_drops", Disturbance::expression, 0}};
  const BenchRows row(out, "occlusion");
  for (const Case& c : kCases) {
    const OcclusionResult r = measure_occlusion(model.model(), c.disturbance, c.fraction, 20, 10);
    for (int d = 0; d < kMethods; ++d) {
      const std::string variant = std::string(c.name) + "_" + name_of(static_cast<RejectionMethod>(d));
      row(variant, "mean_px", r.mean_px[d]);
      row(variant, "fraction_over_3px", r.fraction_over_3px[d]);
      row(variant, "us_a_solve", r.us[d]);
    }
  }
}

}  // namespace pliant::host
