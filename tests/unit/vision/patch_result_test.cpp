// The uncertainty that is claimed for a match, and when a match is accepted.
#include "vision/patch_result.hpp"

#include <doctest/doctest.h>

#include "vision/patch_tuning.hpp"

namespace patch_result_test {

using namespace pliant;
using namespace pliant::patch;

namespace {

Measurement measurement(Sym2 information, float noise_square) {
  Measurement m;
  m.information = information;
  m.gain = 1.1f;
  m.bias = -3;
  m.correlation = 0.95f;
  m.pixels = 121;
  m.residual_square = noise_square;
  m.noise_square = noise_square;
  return m;
}

PatchResult described(const Measurement& m, Vec2 along, bool accepts_edges) {
  PatchResult r;
  describe(m, along, accepts_edges ? &kNormalFlow : nullptr, r);
  return r;
}

}  // namespace

TEST_CASE("information is that of the noise, with a floor of the noise and one of the position") {
  const PatchResult r = described(measurement({4000, 0, 1000}, 9), {}, false);
  const double floor = 0.02 * 0.02;
  CHECK(r.rank == 2);
  CHECK(double(r.information.xx) == doctest::Approx(1 / (9 / 4000.0 + floor)).epsilon(1e-4));
  CHECK(double(r.information.yy) == doctest::Approx(1 / (9 / 1000.0 + floor)).epsilon(1e-4));
  CHECK(r.residual == doctest::Approx(3));
  const PatchResult quiet = described(measurement({4000, 0, 1000}, 0), {}, false);
  CHECK(double(quiet.information.xx) == doctest::Approx(1 / (1 / 4000.0 + floor)).epsilon(1e-4));
  const PatchResult sharp = described(measurement({1e9f, 0, 1e9f}, 0), {}, false);
  CHECK(double(sharp.information.xx) == doctest::Approx(1 / floor).epsilon(1e-3));
}

TEST_CASE("with edges accepted the rank is that of the gradients above the template's own noise") {
  // Noise alone makes 0.23 / 2 * noise * pixels = 13.9 times the noise.
  CHECK(described(measurement({4000, 0, 1000}, 1), {}, true).rank == 2);
  CHECK(described(measurement({4000, 0, 20}, 1), {}, true).rank == 1);
  CHECK(described(measurement({20, 0, 20}, 1), {}, true).rank == 0);
  const PatchResult edge = described(measurement({4000, 0, 20}, 1), {}, true);
  CHECK(edge.information.xx > 100);
  CHECK(edge.information.yy == doctest::Approx(0).scale(1));
  CHECK(described(measurement({4000, 0, 1000}, 1), {1, 0}, true).rank == 1);  // the search was confined
}

TEST_CASE("of a search that an edge has confined, only the gradients across the edge count") {
  // What is added along the edge, so that the search does not move there, is as large as it likes.
  CHECK(described(measurement({20, 0, 4000}, 1), {1, 0}, true).rank == 0);
  CHECK(described(measurement({5, 0, 4000}, 1), {1, 0}, true).rank == 0);
  CHECK(described(measurement({4000, 0, 20}, 1), {1, 0}, true).rank == 1);
}

TEST_CASE("the distance of a result of rank one counts only along its gradient") {
  PatchResult r = described(measurement({4000, 0, 20}, 1), {}, true);
  CHECK(double(informed_distance({3, 4}, r)) == doctest::Approx(3).epsilon(1e-3));
  r.rank = 2;
  CHECK(double(informed_distance({3, 4}, r)) == doctest::Approx(5));
}

TEST_CASE("each reason to refuse a result is named") {
  const PatchOptions options;
  const PatchResult good = described(measurement({4000, 0, 1000}, 1), {}, false);
  CHECK(judge(good, good.x, options) == PatchStatus::ok);
  PatchResult r = good;
  r.rank = 0;
  CHECK(judge(r, r.x, options) == PatchStatus::flat);
  r = good;
  r.correlation = options.min_correlation - 0.01f;
  CHECK(judge(r, r.x, options) == PatchStatus::low_correlation);
  r = good;
  r.gain = kPatchTuning.max_gain + 0.01f;
  CHECK(judge(r, r.x, options) == PatchStatus::bad_light);
  r = good;
  r.bias = -kPatchTuning.max_bias_grey - 1;
  CHECK(judge(r, r.x, options) == PatchStatus::bad_light);
  PatchOptions near = options;
  near.max_move_px = 1;
  CHECK(judge(good, good.x + Vec2{0.8f, 0.8f}, near) == PatchStatus::diverged);
}

}  // namespace patch_result_test
