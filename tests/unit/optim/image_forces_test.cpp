// Rejection of image forces: the table of occlusion experiments on a synthetic face-like surface, and the edges.
#include "pliant/image_forces.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "aligned_block.hpp"
#include "dense.hpp"
#include "mcd_runner.hpp"
#include "pliant/robust.hpp"
#include "random.hpp"
#include "sanitized.hpp"

namespace image_forces_test {

using namespace pliant;

namespace {

constexpr std::size_t kPoints = 120, kRigid = 6, kUnknowns = 14;
using Parameters = Eigen::Matrix<double, kUnknowns, 1>;
using Block = Eigen::Matrix<double, 2, kUnknowns>;

/// A shallow dome, 140 x 180 px, seen from the front: rotation, log scale and translation, then eight smooth local fields.
struct Scene {
  std::vector<Block> b;
  std::vector<Vec2> at;

  explicit Scene(Random& random) {
    while (at.size() < kPoints) {
      const float x = random.uniform(-70, 70), y = random.uniform(-90, 90);
      const float z = 60 * (1 - x * x / 8000 - y * y / 13000);
      if (x * x / 4900 + y * y / 8100 > 1) continue;
      at.push_back({x, y});
      Block j = Block::Zero();
      j.leftCols<6>() << 0, static_cast<double>(z), static_cast<double>(-y), static_cast<double>(x), 1, 0,
          static_cast<double>(-z), 0, static_cast<double>(x), static_cast<double>(y), 0, 1;
      const float center[8][2] = {{-30, -40}, {30, -40}, {-30, -20}, {30, -20},
                                  {-25, 45},  {25, 45},  {0, 60},    {0, 20}};
      for (int k = 0; k < 8; ++k) {
        const double dx = static_cast<double>(x - center[k][0]), dy = static_cast<double>(y - center[k][1]);
        const double r2 = (dx * dx + dy * dy) / (28.0 * 28.0);
        if (r2 < 1) j(k % 2 == 0 || k > 5 ? 1 : 0, 6 + k) = (1 - r2) * (1 - r2);
      }
      b.push_back(j);
    }
  }
};

enum class Outliers { none, random, moving, standing };

/// Forces at the old state, and at a predicted state that includes four fifths of the motion.
struct Trial {
  std::vector<Vec2> force;
  Parameters truth;
};

Vec2 to_vec(const Eigen::Vector2d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y())};
}

Parameters random_motion(Random& random) {
  Parameters q;
  const double sd[6] = {0.03, 0.03, 0.03, 0.015, 4, 4};
  for (std::size_t k = 0; k < kUnknowns; ++k)
    q[static_cast<Eigen::Index>(k)] = (k < 6 ? sd[k] : 1.5) * static_cast<double>(random.normal());
  return q;
}

Trial make_trial(const Scene& scene, Outliers kind, double fraction, bool at_prediction, Random& random) {
  const Parameters motion = random_motion(random);
  Parameters predicted = Parameters::Zero();
  if (at_prediction)
    for (Eigen::Index k = 0; k < predicted.size(); ++k)
      predicted[k] = motion[k] * (0.8 + 0.1 * static_cast<double>(random.normal()));
  Parameters foreign = random_motion(random);
  foreign.tail<8>().setZero();
  foreign.segment<2>(4) *= 3;
  std::vector<std::size_t> order(kPoints);
  const Vec2 middle = scene.at[static_cast<std::size_t>(random.below(kPoints))];
  std::vector<float> key(kPoints);
  for (std::size_t i = 0; i < kPoints; ++i) {
    order[i] = i;
    key[i] = kind == Outliers::random ? random.uniform(0, 1) : length(scene.at[i] - middle);
  }
  std::sort(order.begin(), order.end(), [&](std::size_t x, std::size_t y) { return key[x] < key[y]; });
  std::vector<bool> bad(kPoints, false);
  for (std::size_t i = 0; kind != Outliers::none && i < static_cast<std::size_t>(fraction * kPoints); ++i)
    bad[order[i]] = true;
  Trial trial{std::vector<Vec2>(kPoints), motion - predicted};
  for (std::size_t i = 0; i < kPoints; ++i) {
    const Eigen::Vector2d noise(0.4 * static_cast<double>(random.normal()),
                                0.4 * static_cast<double>(random.normal()));
    Eigen::Vector2d moved = scene.b[i] * motion;
    const Vec2 wild{random.uniform(-12, 12), random.uniform(-12, 12)};
    if (bad[i] && kind == Outliers::random)
      moved += Eigen::Vector2d(static_cast<double>(wild.x), static_cast<double>(wild.y));
    if (bad[i] && kind == Outliers::moving) moved = scene.b[i] * foreign;
    if (bad[i] && kind == Outliers::standing) moved.setZero();
    trial.force[i] = to_vec(moved + noise - scene.b[i] * predicted);
  }
  return trial;
}

std::vector<Vec2> residuals(const Scene& scene, const Trial& trial, const Parameters& q) {
  std::vector<Vec2> r(kPoints);
  for (std::size_t i = 0; i < kPoints; ++i) r[i] = trial.force[i] - to_vec(scene.b[i] * q);
  return r;
}

/// Weighted least squares with weak priors; `rounds` of robust weights (Huber, then Tukey) on the points kept.
Parameters solve(const Scene& scene, const Trial& trial, const std::vector<std::uint8_t>& keep, int rounds,
                 Parameters q = Parameters::Zero(), bool starts_robust = false) {
  for (int round = 0; round <= rounds; ++round) {
    std::vector<Vec2> r = residuals(scene, trial, q);
    std::vector<float> lengths;
    for (std::size_t i = 0; i < kPoints; ++i)
      if (keep[i] != 0) lengths.push_back(length(r[i]));
    const float scale = std::max(robust_scale(lengths.data(), lengths.size()), 0.1f);
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(2 * kPoints, kUnknowns), weighted = rows;
    Eigen::VectorXd force = Eigen::VectorXd::Zero(2 * kPoints);
    for (std::size_t i = 0; i < kPoints; ++i) {
      if (keep[i] == 0) continue;
      const Loss loss = round == 0 && !starts_robust
                            ? Loss::squares
                            : (round < 4 && !starts_robust ? Loss::huber : Loss::tukey);
      const double w = static_cast<double>(evaluate(loss, length(r[i]) / scale).weight);
      const auto row = static_cast<Eigen::Index>(2 * i);
      rows.middleRows<2>(row) = scene.b[i];
      weighted.middleRows<2>(row) = w * scene.b[i];
      force(row) = static_cast<double>(trial.force[i].x);
      force(row + 1) = static_cast<double>(trial.force[i].y);
    }
    Eigen::MatrixXd h = Eigen::MatrixXd::Zero(kUnknowns, kUnknowns);
    h.diagonal().tail<8>().setConstant(0.05);
    add_product(h, rows, weighted);
    q = solve_symmetric(h, weighted.transpose().lazyProduct(force));
  }
  return q;
}

struct Result {
  double least_squares = 0, robust = 0, rejection = 0, rejection_six = 0, readmission = 0;
};

double error_px(const Scene& scene, const Parameters& q, const Parameters& truth) {
  double sum = 0;
  for (std::size_t i = 0; i < kPoints; ++i) sum += (scene.b[i] * (q - truth)).norm() / kPoints;
  return sum;
}

/// The rigid columns: the row of x, then that of y.
std::vector<float> rows_of(const Block& b) {
  std::vector<float> rows;
  for (Eigen::Index row = 0; row < 2; ++row)
    for (Eigen::Index k = 0; k < static_cast<Eigen::Index>(kRigid); ++k)
      rows.push_back(static_cast<float>(b(row, k)));
  return rows;
}

struct RejectorRunner {
  RejectorRunner() : block(measured_bytes<ForceRejector>(limits)), arena(block.data(), block.size()) {
    REQUIRE(create_in(arena, rejector, limits) == Status::ok);
  }
  std::vector<std::uint8_t> reject(const Scene& scene, const Trial& trial, McdStarts starts,
                                   float cutoff = ForceOptions{}.cutoff) {
    std::vector<float> jacobian;
    for (const Block& b : scene.b)
      for (const float each : rows_of(b)) jacobian.push_back(each);
    std::vector<std::uint8_t> keep(kPoints);
    ForceOptions options;
    options.starts = starts;
    options.cutoff = cutoff;
    REQUIRE(rejector.reject(jacobian.data(), trial.force.data(), kPoints, kRigid, options, keep.data()) ==
            Status::ok);
    return keep;
  }
  McdLimits limits{kPoints, kRigid};
  AlignedBlock block;
  Arena arena;
  ForceRejector rejector;
};

/// Keeps the points whose residual is at most 3.5 times the robust scale of those kept so far, as the frame solver does.
void readmit(const std::vector<Vec2>& residual, std::vector<std::uint8_t>& keep) {
  std::vector<float> kept;
  for (std::size_t i = 0; i < keep.size(); ++i)
    if (keep[i] != 0) kept.push_back(length(residual[i]));
  const float limit = 3.5f * max(robust_scale(kept.data(), kept.size()), 0.1f);
  for (std::size_t i = 0; i < keep.size(); ++i) keep[i] = length(residual[i]) <= limit;
}

constexpr int kTrials = kSanitized ? 10 : 40;

Result experiment(Outliers kind, double fraction, bool at_prediction) {
  Random random(2024);
  RejectorRunner runner;
  Result mean;
  const std::vector<std::uint8_t> all(kPoints, 1);
  for (int k = 0; k < kTrials; ++k) {
    const Scene scene(random);
    const Trial trial = make_trial(scene, kind, fraction, at_prediction, random);
    const auto add = [&](double& sum, const Parameters& q) {
      sum += error_px(scene, q, trial.truth) / kTrials;
    };
    add(mean.least_squares, solve(scene, trial, all, 0));
    add(mean.robust, solve(scene, trial, all, 10));
    add(mean.rejection_six, solve(scene, trial, runner.reject(scene, trial, McdStarts::all_six), 10));
    std::vector<std::uint8_t> keep = runner.reject(scene, trial, McdStarts::median_ball);
    Parameters q = solve(scene, trial, keep, 10);
    add(mean.rejection, q);
    readmit(residuals(scene, trial, q), keep);
    add(mean.readmission, solve(scene, trial, keep, 3, q, true));
  }
  return mean;
}

void print(const std::string& name, const Result& r) {
  MESSAGE(name, ": least squares ", r.least_squares, ", robust weights ", r.robust, ", rejection ",
          r.rejection, " (six starts ", r.rejection_six, "), re-admission ", r.readmission, " px");
}

}  // namespace

TEST_CASE("without outliers re-admission costs next to nothing") {
  const Result r = experiment(Outliers::none, 0, true);
  print("none", r);
  CHECK(r.rejection > r.least_squares);
  CHECK(r.readmission < r.rejection);
  CHECK(r.readmission < 1.25 * r.least_squares);
}

TEST_CASE("random outliers: robust weights suffice, rejection with re-admission is more accurate") {
  for (double fraction : {0.20, 0.35}) {
    const Result r = experiment(Outliers::random, fraction, true);
    print(fraction < 0.3 ? "random 20 %" : "random 35 %", r);
    CHECK(r.robust < 0.5 * r.least_squares);
    CHECK(r.readmission < r.robust * 1.05);
    CHECK(r.readmission < 0.4);
  }
}

TEST_CASE("an occluder that moves: weights alone lose the object, rejection does not") {
  for (double fraction : {0.20, 0.35}) {
    const Result old = experiment(Outliers::moving, fraction, false),
                 r = experiment(Outliers::moving, fraction, true);
    print(fraction < 0.3 ? "moving 20 %, at the old state" : "moving 35 %, at the old state", old);
    print(fraction < 0.3 ? "moving 20 %, at the prediction" : "moving 35 %, at the prediction", r);
    CHECK(r.robust < r.least_squares);
    CHECK(r.rejection < (fraction < 0.3 ? 0.8 : 0.1) * r.robust);
    CHECK(r.readmission < (fraction < 0.3 ? 0.8 : 0.1) * r.robust);
    CHECK(r.readmission <= old.readmission);
    CHECK(r.rejection < 1.3 * r.rejection_six);
  }
}

TEST_CASE("an occluder at rest: rejection needs forces at the predicted state") {
  for (double fraction : {0.20, 0.35}) {
    const Result old = experiment(Outliers::standing, fraction, false),
                 r = experiment(Outliers::standing, fraction, true);
    print(fraction < 0.3 ? "standing 20 %, at the old state" : "standing 35 %, at the old state", old);
    print(fraction < 0.3 ? "standing 20 %, at the prediction" : "standing 35 %, at the prediction", r);
    CHECK(old.rejection > old.robust);
    CHECK(r.rejection < (fraction < 0.3 ? 0.8 : 0.25) * r.robust);
    CHECK(r.readmission < (fraction < 0.3 ? 0.8 : 0.25) * r.robust);
    CHECK(r.readmission < 0.25 * old.readmission);
  }
}

TEST_CASE("at rest nothing is rejected, whatever the noise below the floor looks like") {
  Random random(5);
  const Scene scene(random);
  Trial trial{std::vector<Vec2>(kPoints), Parameters::Zero()};
  RejectorRunner runner;
  const auto count = [](const std::vector<std::uint8_t>& keep) {
    return std::count(keep.begin(), keep.end(), 1);
  };
  CHECK(count(runner.reject(scene, trial, McdStarts::median_ball)) == static_cast<long>(kPoints));
  for (Vec2& f : trial.force)
    f = {0.0625f * static_cast<float>(random.below(2)), 0.0625f * static_cast<float>(random.below(2))};
  CHECK(count(runner.reject(scene, trial, McdStarts::median_ball)) == static_cast<long>(kPoints));
  trial.force[7] = {20, -20};
  CHECK(runner.reject(scene, trial, McdStarts::median_ball)[7] == 0);
  for (const float length_px : {0.09f, 0.15f}) {  // the floor is 0.1 px
    trial.force.assign(kPoints, {});
    trial.force[7] = {length_px, 0};
    CHECK(runner.reject(scene, trial, McdStarts::median_ball)[7] == (length_px < 0.1f));
  }
}

TEST_CASE("an unobserved parameter and values that are not finite are handled") {
  Random random(6);
  Scene scene(random);
  Trial trial = make_trial(scene, Outliers::random, 0.2, true, random);
  RejectorRunner runner;
  trial.force[3].y = std::numeric_limits<float>::quiet_NaN();
  scene.b[5](1, 2) = std::numeric_limits<double>::infinity();
  std::vector<std::uint8_t> keep = runner.reject(scene, trial, McdStarts::median_ball);
  CHECK(keep[3] == 0);
  CHECK(keep[5] == 0);
  const auto kept = std::count(keep.begin(), keep.end(), 1);
  CHECK((kept > 70 && kept < 100));
  for (Block& b : scene.b) b.col(2).setZero();
  keep = runner.reject(scene, trial, McdStarts::all_six);
  const auto still = std::count(keep.begin(), keep.end(), 1);
  CHECK((still > 70 && still < 100));
  for (Block& b : scene.b)
    b.col(2) = b.col(0) + 0.7 * b.col(1);  // a parameter that does what others do together tells nothing new
  CHECK(runner.reject(scene, trial, McdStarts::all_six) == keep);
  for (const bool tells_something :
       {false, true}) {  // beside them: by less than the points can tell, and by more
    for (Block& b : scene.b)
      for (Eigen::Index i = 0; i < 2; ++i)
        b(i, 2) =
            b(i, 0) + 0.7 * b(i, 1) + (tells_something ? 3 : 0.01) * static_cast<double>(random.normal());
    CHECK((runner.reject(scene, trial, McdStarts::all_six) == keep) == !tells_something);
  }
}

TEST_CASE("a decision does not depend on the decisions before it") {
  Random random(9);
  const Scene scene(random);
  const Trial trial = make_trial(scene, Outliers::moving, 0.2, true, random);
  Scene other(random);
  for (Block& b : other.b) b *= 1e5;
  RejectorRunner fresh, used;
  used.reject(other, trial, McdStarts::median_ball);
  const std::vector<std::uint8_t> keep = fresh.reject(scene, trial, McdStarts::median_ball);
  CHECK(used.reject(scene, trial, McdStarts::median_ball) == keep);
  for (std::size_t i = 0; i < kPoints; ++i) {
    const std::vector<float> jacobian = rows_of(scene.b[i]);
    CHECK(used.rejector.agrees(jacobian.data(), trial.force[i]) ==
          fresh.rejector.agrees(jacobian.data(), trial.force[i]));
  }
}

TEST_CASE("a smaller quantile rejects more forces") {
  Random random(10);
  const Scene scene(random);
  const Trial trial = make_trial(scene, Outliers::none, 0, true, random);
  RejectorRunner runner;
  const auto kept_with = [&](float cutoff) {
    const std::vector<std::uint8_t> keep = runner.reject(scene, trial, McdStarts::median_ball, cutoff);
    return std::count(keep.begin(), keep.end(), 1);
  };
  CHECK(kept_with(0.5f) < kept_with(0.9f));
  CHECK(kept_with(0.9f) < kept_with(0.999f));
}

TEST_CASE("no force agrees where nothing has been decided, nor one that is no number") {
  Random random(11);
  const Scene scene(random);
  const Trial trial{std::vector<Vec2>(kPoints), Parameters::Zero()};
  RejectorRunner runner;
  std::vector<float> jacobian = rows_of(scene.b[0]);
  CHECK_FALSE(runner.rejector.agrees(jacobian.data(), {}));
  runner.reject(scene, trial, McdStarts::median_ball);
  CHECK(runner.rejector.agrees(jacobian.data(), {}));
  CHECK_FALSE(runner.rejector.agrees(jacobian.data(), {std::numeric_limits<float>::quiet_NaN(), 0}));
  jacobian[11] = std::numeric_limits<float>::infinity();
  CHECK_FALSE(runner.rejector.agrees(jacobian.data(), {}));
  jacobian[11] = 0;
  std::vector<std::uint8_t> keep(kPoints);
  CHECK(runner.rejector.reject(jacobian.data(), trial.force.data(), 1, kRigid, {}, keep.data()) ==
        Status::too_few_points);
  CHECK_FALSE(runner.rejector.agrees(jacobian.data(), {}));
}

TEST_CASE("limits beyond the largest numbers of rows and columns are those") {
  McdLimits most, beyond;
  most.rows = kMcdMaxRows;
  most.columns = kForceMaxColumns;
  beyond.rows = kMcdMaxRows + 1000;
  beyond.columns = kForceMaxColumns + 4;
  CHECK(measured_bytes<ForceRejector>(beyond) == measured_bytes<ForceRejector>(most));
}

TEST_CASE(
    "a single force agrees where `reject` keeps it, also where most forces do not differ in some direction") {
  Random random(8);
  const Scene scene(random);
  RejectorRunner runner;
  for (const float noise_px : {0.0f, 1e-4f, 0.3f})
    for (const Vec2 usual : {Vec2{0, 0}, Vec2{1, 0}, Vec2{-2, 1}}) {
      Trial trial{std::vector<Vec2>(kPoints), Parameters::Zero()};
      for (std::size_t i = 0; i < kPoints; ++i)
        trial.force[i] =
            (i % 3 == 0 ? Vec2{6, 2} : usual) + Vec2{noise_px * random.normal(), noise_px * random.normal()};
      const std::vector<std::uint8_t> keep = runner.reject(scene, trial, McdStarts::median_ball);
      for (std::size_t i = 0; i < kPoints; ++i) {
        const std::vector<float> jacobian = rows_of(scene.b[i]);
        CHECK(runner.rejector.agrees(jacobian.data(), trial.force[i]) == (keep[i] != 0));
      }
    }
}

TEST_CASE("few points are all kept, and bad arguments change nothing") {
  RejectorRunner runner;
  const std::vector<float> jacobian(kPoints * 2 * kRigid, 1.0f);
  std::vector<Vec2> force(kPoints + 1, Vec2{1, 0});
  std::vector<std::uint8_t> keep(kPoints + 1, 7);
  ForceOptions options;
  const auto reject = [&](std::size_t rows, std::size_t columns) {
    return runner.rejector.reject(jacobian.data(), force.data(), rows, columns, options, keep.data());
  };
  CHECK(reject(kPoints + 1, 1) == Status::capacity);
  CHECK(reject(10, kRigid + 1) == Status::capacity);
  CHECK(reject(10, 0) == Status::bad_argument);
  CHECK(runner.rejector.reject(nullptr, force.data(), 40, 6, options, keep.data()) == Status::bad_argument);
  CHECK(runner.rejector.reject(jacobian.data(), nullptr, 40, 6, options, keep.data()) ==
        Status::bad_argument);
  CHECK(runner.rejector.reject(jacobian.data(), force.data(), 40, 6, options, nullptr) ==
        Status::bad_argument);
  for (const float cutoff : {0.0f, 1.0f}) {
    options.cutoff = cutoff;
    CHECK(reject(40, 6) == Status::bad_argument);
  }
  options = {};
  options.noise_px = std::numeric_limits<float>::quiet_NaN();
  CHECK(reject(40, 6) == Status::bad_argument);
  CHECK(keep == std::vector<std::uint8_t>(kPoints + 1, 7));
  options = {};
  force[2].x = std::numeric_limits<float>::quiet_NaN();
  CHECK(reject(29, 6) == Status::too_few_points);
  for (std::size_t i = 0; i < 29; ++i) CHECK(keep[i] == (i == 2 ? 0 : 1));
  CHECK(reject(30, 6) == Status::too_few_points);  // 29 finite ones
  options.noise_px = 0;
  CHECK(reject(31, 6) == Status::ok);
  for (std::size_t bytes = 0; bytes < runner.arena.used_bytes(); bytes += 97) {
    Arena arena(runner.block.data(), bytes);
    ForceRejector other;
    CHECK(create_in(arena, other, runner.limits) == Status::out_of_memory);
  }
}

}  // namespace image_forces_test
