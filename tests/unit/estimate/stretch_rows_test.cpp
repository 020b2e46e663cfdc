// Springs on a sheet that rolls up to a cylinder, bends wrongly and stretches, each by a parameter of its own.
#include "estimate/stretch_rows.hpp"

#include <doctest/doctest.h>

#include <cstring>
#include <limits>

#include "open_model.hpp"
#include "pliant/estimator.hpp"
#include "random.hpp"
#include "sheet_model.hpp"

namespace stretch_rows_test {

using namespace pliant;
using namespace sheet;

namespace {

struct Rows {
  OpenModel rig;
  InArena<Cascade> cascade{rig.model};
  InArena<StretchRows> rows{rig.model, cascade->samples_per_point()};

  explicit Rows(bool corrects = true) : rig(sheet_model(Springs::of_sheet().bytes(), corrects)) {
    const float q[3] = {};
    REQUIRE(rows->start(cascade.object, q) == Status::ok);
  }
  float cost(float roll, float bowl, float wide) {
    const float q[3] = {roll, bowl, wide};
    return rows->cost(cascade.object, q);
  }
};

}  // namespace

TEST_CASE(
    "a sheet at rest costs nothing, one that is stretched evenly costs half a square for each spring along") {
  Rows r;
  CHECK(r.cost(0, 0, 0) < 1e-4f);
  // 10 % of stretch at 1 % of deviation: rows along u have a residual of 10, diagonals of 5, columns of none.
  const float rows = kSpringGrid * (kSpringGrid - 1), diagonals = (kSpringGrid - 1) * (kSpringGrid - 1);
  CHECK(r.cost(0, 0, 0.1f) == doctest::Approx(double(0.5f * rows + 0.125f * diagonals)).epsilon(0.02));
}

TEST_CASE(
    "rolling a sheet up to a cylinder is free where its shapes keep lengths, and dear where they do not") {
  Rows kept, stretched(false);
  CHECK(stretched.cost(1, 0, 0) > 20 * kept.cost(1, 0, 0));
  CHECK(kept.cost(0, 1, 0) > 20 * kept.cost(1, 0, 0));  // a bowl stretches its rim
  // The residuals that are left are those of chords and of the series' end, below half a percent.
  CHECK(kept.cost(1, 0, 0) < 0.5f * 85 * 0.25f);
}

TEST_CASE("the rows are the cost's derivatives, by central differences") {
  Rows r;
  Random random(5);
  for (int trial = 0; trial < 20; ++trial) {
    const auto any = [&random](double from) { return static_cast<float>(from + random.uniform()); };
    const float q[3] = {2 * any(-0.5), 2 * any(-0.5), any(-0.5)};
    InArena<NormalEquations> equations(std::size_t{5});
    equations->reset(5);
    r.rows->add(r.cascade.object, q, 2, equations.object);
    for (std::size_t k = 0; k < 3; ++k) {
      constexpr float kStep = 5e-3f;
      float more[3] = {q[0], q[1], q[2]}, less[3] = {q[0], q[1], q[2]};
      more[k] += kStep;
      less[k] -= kStep;
      const float slope =
          (r.rows->cost(r.cascade.object, more) - r.rows->cost(r.cascade.object, less)) / (2 * kStep);
      CAPTURE(trial);
      CAPTURE(k);
      CHECK(magnitude(equations->g(2 + k) + slope) < 0.01f * (magnitude(slope) + 50));
      CHECK(equations->h(2 + k, 2 + k) > 0);
    }
    for (std::size_t k = 0; k < 2; ++k) {  // the unknowns of the pose stay free
      CHECK(equations->g(k) == 0);
      CHECK(equations->h(k, k) == 0);
    }
  }
}

TEST_CASE("the equations are those of springs at every number of free parameters") {
  Rows r;
  const std::uint8_t only_wide[3] = {0, 0, 1};
  const float q[3] = {0.5f, 0.2f, 0.1f};
  InArena<NormalEquations> all(std::size_t{3}), one(std::size_t{1});
  all->reset(3);
  r.rows->add(r.cascade.object, q, 0, all.object);
  r.cascade->set_free(only_wide);
  REQUIRE(r.rows->start(r.cascade.object, q) == Status::ok);
  one->reset(1);
  r.rows->add(r.cascade.object, q, 0, one.object);
  CHECK(one->g(0) == doctest::Approx(double(all->g(2))).epsilon(1e-3));
  CHECK(one->h(0, 0) == doctest::Approx(double(all->h(2, 2))).epsilon(1e-3));
}

TEST_CASE("a spring whose ends meet has no direction: it pulls nowhere, and the others pull on") {
  Springs springs = Springs::of_sheet();
  springs.points[1] = springs.points[0];
  const OpenModel rig(sheet_model(springs.bytes()));
  InArena<Cascade> cascade(rig.model);
  InArena<StretchRows> rows(rig.model, cascade->samples_per_point());
  const float q[3] = {0.2f, 0.1f, 0.5f};
  REQUIRE(rows->start(cascade.object, q) == Status::ok);
  InArena<NormalEquations> equations(std::size_t{3});
  equations->reset(3);
  rows->add(cascade.object, q, 0, equations.object);
  CHECK(is_finite(rows->cost(cascade.object, q)));
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(is_finite(equations->g(k)));
    for (std::size_t j = 0; j <= k; ++j) CHECK(is_finite(equations->h(k, j)));
  }
  CHECK(equations->h(2, 2) > 0);
}

TEST_CASE("a damaged section is refused") {
  const Springs sound = Springs::of_sheet();
  SpringTable table;
  const auto status = [&table](const std::vector<unsigned char>& bytes) {
    std::vector<std::uint32_t> aligned(bytes.size() / 4 + 1);
    if (!bytes.empty()) std::memcpy(aligned.data(), bytes.data(), bytes.size());
    return SpringTable::open({reinterpret_cast<const std::uint8_t*>(aligned.data()), bytes.size()}, &table);
  };
  const std::vector<unsigned char> bytes = sound.bytes();
  CHECK(status({}) == Status::ok);
  CHECK(table.springs.empty());
  CHECK(status(bytes) == Status::ok);
  CHECK(table.springs.count == sound.springs.size());
  for (std::size_t n = 1; n < bytes.size(); ++n) {
    CHECK(status({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n)}) == Status::bad_table);
    CHECK(table.springs.empty());
  }
  auto longer = bytes;
  longer.resize(bytes.size() + 4);
  CHECK(status(longer) == Status::bad_table);
  Springs least;
  least.points = {{0.1f, 0.1f}, {0.9f, 0.1f}};
  least.springs = {{0, 1, 80, 1}};
  CHECK(status(least.bytes()) == Status::ok);
  least.points.pop_back();
  CHECK(status(least.bytes()) == Status::bad_table);
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinite = std::numeric_limits<float>::infinity();
  const auto with = [&](auto change) {
    Springs s = sound;
    change(s);
    return status(s.bytes());
  };
  for (const float bad : {nan, infinite, -1.0f, 0.0f}) {
    CHECK(with([bad](Springs& s) { s.springs[3].length_mm = bad; }) == Status::bad_table);
    CHECK(with([bad](Springs& s) { s.springs[3].sd_mm = bad; }) == Status::bad_table);
  }
  for (const float bad : {nan, infinite, -0.01f, 1.01f})
    CHECK(with([bad](Springs& s) { s.points[2].y = bad; }) == Status::bad_table);
  CHECK(with([](Springs& s) { s.springs[0].second = kSpringGrid * kSpringGrid; }) == Status::bad_table);
  CHECK(with([](Springs& s) { s.springs[0].first = s.springs[0].second; }) == Status::bad_table);
  CHECK(with([](Springs& s) { s.springs.clear(); }) == Status::bad_table);
  CHECK(with([](Springs& s) { s.springs.resize(1025, s.springs[0]); }) == Status::bad_table);
  CHECK(with([](Springs& s) { s.points.resize(257); }) == Status::bad_table);
  CHECK(with([](Springs& s) { s.springs.resize(1024, s.springs[0]), s.points.resize(256); }) == Status::ok);
}

TEST_CASE("an estimator refuses damaged springs, and does without if its limits say so") {
  auto bytes = Springs::of_sheet().bytes();
  bytes.pop_back();
  const OpenModel rig(sheet_model(bytes));
  const float q[3] = {};
  const Camera camera = centred_camera(320, 240, 400);
  const Pose pose{{1, 0, 0, 0}, {0, 0, 500}};
  EstimatorLimits limits;
  InArena<Estimator> with(rig.model, limits), without(rig.model, without_stretch(limits));
  CHECK(with->start(camera, 320, 240, pose, q, nullptr, {}) == Status::bad_table);
  CHECK_FALSE(with->is_started());
  CHECK(without->start(camera, 320, 240, pose, q, nullptr, {}) == Status::ok);
}

TEST_CASE("springs take a known number of bytes, and none where the table has none") {
  const OpenModel with(sheet_model(Springs::of_sheet().bytes())), none(sheet_model({}));
  const EstimatorLimits limits;
  const auto bytes = [](const OpenModel& rig, const EstimatorLimits& l) {
    return measured_bytes<Estimator>(rig.model, l);
  };
  CHECK(bytes(none, limits) == bytes(none, without_stretch(limits)));
  CHECK(bytes(with, without_stretch(limits)) == bytes(none, limits));
  const std::size_t points = kSpringGrid * kSpringGrid, samples = 5, parameters = 3;
  const std::size_t least = 12 * points * (samples + 1 + parameters);
  CHECK(bytes(with, limits) - bytes(none, limits) >= least);
  CHECK(bytes(with, limits) - bytes(none, limits) < least + 300);
}

TEST_CASE("springs count in the work of a frame, and its solves end within what it may take") {
  const OpenModel rig(sheet_model(Springs::of_sheet().bytes()));
  const float truth[3] = {0.9f, 0, 0}, start[3] = {-0.6f, 0, 0};
  const Camera camera = centred_camera(320, 240, 400);
  const Pose pose{exp_rotation({0.1f, 0.5f, 0}), {0, 0, 400}},
      turned{exp_rotation({0, 0.3f, 0}), {3, 0, 400}};
  const WorkCosts costs{1, 100, 10, 1000};
  constexpr std::uint32_t kPoints = 30;
  const auto spring_rows = static_cast<std::uint32_t>(kRowsASpring * Springs::of_sheet().springs.size());
  const float three_passes = costs.row * 3 * static_cast<float>(kPoints + spring_rows);
  FrameWork work[2];
  for (const bool is_limited : {false, true}) {
    InArena<Estimator> estimator(rig.model, EstimatorLimits{}), seen(rig.model, EstimatorLimits{});
    EstimatorOptions options;
    options.time_ns = 0;
    REQUIRE(estimator->start(camera, 320, 240, pose, start, nullptr, options) == Status::ok);
    REQUIRE(seen->start(camera, 320, 240, turned, truth, nullptr, {}) == Status::ok);
    std::vector<Observation> observations(kPoints);
    for (std::uint32_t k = 0; k < kPoints; ++k) {
      const Vec2 uv{0.1f + 0.16f * static_cast<float>(k % 6), 0.1f + 0.2f * static_cast<float>(k / 6)};
      Observation& o = observations[k];
      REQUIRE(estimator->add_point(uv, &o.id) == Status::ok);
      REQUIRE(seen->project(uv, &o.x));
      o.information = {4, 0, 4};
    }
    estimator->begin(33'000'000);
    if (is_limited) estimator->limit_work(costs, three_passes);
    estimator->predict();
    const SolverReport report = estimator->solve({observations.data(), observations.size()});
    CHECK(report.final_cost > 0);
    CHECK(report.final_cost < report.initial_cost);
    work[is_limited] = estimator->work();
  }
  CHECK(work[0].rows % (kPoints + spring_rows) == 0);
  CHECK(costs.of_solves(work[0]) > 1.3f * three_passes);
  CHECK(costs.of_solves(work[1]) <= three_passes);
}

TEST_CASE("springs find the bend of a sheet of which a few noisy points are seen") {
  // The bowl and the stretch explain the noise as well as the roll does; only springs tell that paper does neither.
  const OpenModel rig(sheet_model(Springs::of_sheet().bytes()));
  const float truth[3] = {0.9f, 0, 0}, start[3] = {0.6f, 0, 0};
  const Camera camera = centred_camera(320, 240, 400);
  const Pose pose{exp_rotation({0.1f, 0.5f, 0}), {0, 0, 400}};
  float error[2] = {};
  for (const bool has_springs : {false, true}) {
    const EstimatorLimits limits = has_springs ? EstimatorLimits{} : without_stretch(EstimatorLimits{});
    InArena<Estimator> estimator(rig.model, limits), seen(rig.model, limits);
    Random random(7);
    EstimatorOptions options;
    options.time_ns = 0;  // of the frame that is fitted
    for (int trial = 0; trial < 10; ++trial) {
      REQUIRE(estimator->start(camera, 320, 240, pose, start, nullptr, options) == Status::ok);
      REQUIRE(seen->start(camera, 320, 240, pose, truth, nullptr, {}) == Status::ok);
      std::vector<Observation> observations;
      for (int k = 0; k < 20; ++k) {
        const Vec2 uv{static_cast<float>(0.1 + 0.4 * random.uniform()),
                      static_cast<float>(0.1 + 0.8 * random.uniform())};
        Observation o;
        REQUIRE(estimator->add_point(uv, &o.id) == Status::ok);
        REQUIRE(seen->project(uv, &o.x));
        o.x = o.x + Vec2{0.5f * random.normal(), 0.5f * random.normal()};
        o.information = {4, 0, 4};
        observations.push_back(o);
      }
      estimator->begin(0);
      for (int round = 0; round < 4; ++round) {
        estimator->predict();
        estimator->solve({observations.data(), observations.size()});
      }
      for (std::size_t k = 0; k < 3; ++k)
        error[has_springs] += magnitude(estimator->parameters()[k] - truth[k]);
    }
  }
  CHECK(error[1] < 0.6f * error[0]);
}

}  // namespace stretch_rows_test
