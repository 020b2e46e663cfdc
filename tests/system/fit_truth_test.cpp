// Fits with known truth: the built-in face anywhere, ICT-FaceKit's and a real photograph's points with PLIANT_DATA.
#include "fit_truth.hpp"

#include <doctest/doctest.h>

#include "baked_face.hpp"
#include "host/bake/bake.hpp"
#include "host/commands/image_fit.hpp"
#include "host/io/files.hpp"
#include "ict_face.hpp"
#include "real_data.hpp"
#include "sanitized.hpp"
#include "talking_face.hpp"

using namespace pliant;
using namespace fit_truth;

namespace {

constexpr int kFaces = kSanitized ? 2 : 12;

void check(BakedModel& face, const char* name) {
  for (std::size_t points : {std::size_t{80}, std::size_t{160}}) {
    Study study(face, points);
    const Summary s = run(study, points, kFaces);
    print(s, name, points);
    CHECK(quantile(s.excess, 1) < 0.01);
    CHECK(s.median(s.fit, &Errors::turn_deg) < 1);
    CHECK(s.median(s.fit, &Errors::turn_deg) < s.median(s.null, &Errors::turn_deg));
    CHECK(s.median(s.fit, &Errors::rms_px) < 0.5 * s.median(s.null, &Errors::rms_px));
    CHECK(s.median(s.fit, &Errors::surface_mm) < 0.8 * s.median(s.null, &Errors::surface_mm));
    CHECK(std::abs(quantile(s.outlier_turn, 0.5) - s.median(s.fit, &Errors::turn_deg)) < 0.5);
  }
}

/// ICT-FaceKit's face, coarser than by default so that it bakes in a moment.
const std::vector<std::uint8_t>& ict_table() {
  static const std::vector<std::uint8_t> table = [] {
    host::bake::BakeOptions options;
    options.size = 64;
    return host::bake::bake_source(narrow_face(), options, nullptr);
  }();
  return table;
}

}  // namespace

TEST_CASE(
    "random people of the built-in face: the optimum is reached, the pose is within a degree, and far nearer "
    "than "
    "the mean face") {
  check(baked_face(), "built-in face");
}

TEST_CASE(
    "random people of 100 identities: the optimum is reached, the pose to a degree, and far nearer than the "
    "mean face") {
  if (require_data() == nullptr) return;
  BakedModel face(ict_table());
  check(face, "ICT face");
}

TEST_CASE("a real face: 25 points of a photograph give a plausible person") {
  const char* data = require_data();
  if (data == nullptr) return;
  const std::string path = std::string(PLIANT_SCRATCH) + "/fit_truth_ict.plm";
  host::write_file(path, std::string(ict_table().begin(), ict_table().end()));
  const host::ModelFile file(path);
  const auto named = TalkingFace(std::string(data) + "/franck", 1).initial_landmarks();
  REQUIRE(named.size() == 25);
  host::FitSetup setup;
  setup.size = {TalkingFace::kWidth, TalkingFace::kHeight};
  const host::FitFile fit = host::fit_to_points(file, "points", named, setup);
  std::vector<float> q(file.model().parameters().count, 0.0f);
  host::apply(fit.parameters, "fit", file.model(), q.data());
  double largest = 0, length_of_q = 0;
  for (std::size_t k = 0; k < q.size(); ++k) {
    const double z = double(q[k] / file.model().parameters()[k].sd);
    largest = std::max(largest, std::abs(z));
    length_of_q += z * z;
  }
  CHECK(largest <= 3);
  CHECK(fit.rms_px < 6);
  CHECK(fit.inliers >= 20);

  // The same points with plain squares and everything free, by the library and in double precision.
  BakedModel face(ict_table());
  std::vector<Correspondence> points;
  Vec2 low{1e9f, 1e9f}, high{-1e9f, -1e9f};
  for (const host::NamedPoint& p : named) {
    low = min(low, p.x);
    high = max(high, p.x);
  }
  for (const host::NamedPoint& p : named)
    points.push_back({face.uv(p.name), p.x, 0.005f * length(high - low)});
  FitOptions options;
  options.width = TalkingFace::kWidth;
  options.height = TalkingFace::kHeight;
  options.robust = false;
  InArena<Fitter> fitter(face.model, FitLimits{});
  std::vector<float> plain = face.rest();
  FitReport report;
  REQUIRE(fitter->fit({points.data(), points.size()}, options, plain.data(), &report) == Status::ok);
  face.cascade.set_all_free();
  const DoubleFit exact(face.model, face.cascade, points, options);
  const auto reached = exact.state_of(report.view, face.cascade, plain);
  const auto best = exact.minimise(reached);
  double squares = 0;
  DoubleFit data_alone = exact;  // the cost without priors is half the squares in deviations
  data_alone.sd.setConstant(1e9);
  data_alone.log_f_sd = 1e9;
  squares = 2 * data_alone.cost(best) * std::pow(double(points[0].sd_px), 2);
  const double best_rms = std::sqrt(squares / double(points.size()));
  std::printf(
      "Talking Face, frame 0: rms %.2f px over %zu of 25 points, largest parameter %.2f sd, all together "
      "%.2f; plain squares %.2f px, "
      "double-precision bounded optimum %.2f px (cost %.4f %% below)\n",
      double(fit.rms_px), fit.inliers, largest, std::sqrt(length_of_q), double(report.rms_px), best_rms,
      100 * (exact.cost(reached) / exact.cost(best) - 1));
  CHECK(exact.cost(reached) < 1.01 * exact.cost(best));
  CHECK(best_rms < 6);
}
