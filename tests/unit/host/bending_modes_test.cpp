// Bending modes against the theory of beams and plates, and what every mode has to keep.
#include "host/bake/bending_modes.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "bake_sheet.hpp"
#include "host/bake/symmetric_eigen.hpp"

namespace bending_modes_test {

using namespace pliant;
using namespace pliant::host::bake;

namespace {

/// A sheet of n x m quads, `width` by `height`, lifted to a part of a tube of this radius unless it is 0.
BendingMesh plate(int n, int m, float width, float height, float radius = 0) {
  BendingMesh mesh;
  for (int j = 0; j <= m; ++j)
    for (int i = 0; i <= n; ++i) {
      const float x = width * static_cast<float>(i) / static_cast<float>(n),
                  y = height * static_cast<float>(j) / static_cast<float>(m);
      mesh.position.push_back(radius == 0
                                  ? Vec3{x, y, 0}
                                  : Vec3{radius * std::sin(x / radius), y, radius * std::cos(x / radius)});
    }
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i, b = a + 1, c = a + n + 2, d = a + n + 1;
      mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
    }
  mesh.is_fixed.assign(mesh.position.size(), 0);
  return mesh;
}

/// Correlation of the displacements along z with a function of (x, y).
template <class F>
double likeness(const BendingMesh& mesh, const std::vector<Vec3>& mode, F f) {
  double xy = 0, xx = 0, yy = 0;
  for (std::size_t v = 0; v < mode.size(); ++v) {
    const double a = static_cast<double>(mode[v].z),
                 b = f(static_cast<double>(mesh.position[v].x), static_cast<double>(mesh.position[v].y));
    xy += a * b, xx += a * a, yy += b * b;
  }
  return std::fabs(xy) / std::sqrt(xx * yy);
}

double rms(const std::vector<Vec3>& mode) {
  double sum = 0;
  for (const Vec3 d : mode) sum += static_cast<double>(dot(d, d));
  return std::sqrt(sum / static_cast<double>(mode.size()));
}

/// Largest relative change of an edge's length to first order, over the mode's mean displacement per diagonal.
float stretch(const BendingMesh& mesh, const std::vector<Vec3>& mode) {
  float worst = 0;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto a = static_cast<std::size_t>(t[k]), b = static_cast<std::size_t>(t[(k + 1) % 3]);
      const Vec3 e = mesh.position[b] - mesh.position[a];
      worst = max(worst, magnitude(dot(e, mode[b] - mode[a])) / dot(e, e));
    }
  return worst;
}

}  // namespace

TEST_CASE("a narrow strip that is held at one end has the first modes of a cantilever") {
  BendingMesh mesh = plate(60, 3, 100, 5);
  for (std::size_t v = 0; v < mesh.position.size(); ++v) mesh.is_fixed[v] = mesh.position[v].x < 1.7f;
  const BendingModes modes = find_bending_modes(mesh, 4, 1);
  REQUIRE(modes.displacement.size() == 4);
  // Of the length that is free, which starts half an edge before the last vertices that are held.
  const double start = 100.0 / 60, free_length = 100 - start;
  const auto beam = [&](double beta, double ratio) {
    return [=](double x, double) {
      const double b = beta * std::max(0.0, x - start) / free_length;
      return std::cosh(b) - std::cos(b) - ratio * (std::sinh(b) - std::sin(b));
    };
  };
  CHECK(likeness(mesh, modes.displacement[0], beam(1.8751, 0.7341)) > 0.9995);
  CHECK(likeness(mesh, modes.displacement[1], beam(4.6941, 1.0185)) > 0.999);
  CHECK(modes.eigenvalue[1] / modes.eigenvalue[0] == doctest::Approx(39.3).epsilon(0.03));
  for (std::size_t v = 0; v < mesh.position.size(); ++v)
    if (mesh.is_fixed[v]) CHECK(length(modes.displacement[0][v]) == 0);
}

TEST_CASE("a free square plate twists first, then bends to a saddle, and moves as a rigid body in no mode") {
  const BendingMesh mesh = plate(24, 24, 80, 80);
  const BendingModes modes = find_bending_modes(mesh, 6, 1);
  REQUIRE(modes.displacement.size() == 6);
  CHECK(likeness(mesh, modes.displacement[0], [](double x, double y) { return (x - 40) * (y - 40); }) > 0.98);
  CHECK(likeness(mesh, modes.displacement[1],
                 [](double x, double y) { return (x - 40) * (x - 40) - (y - 40) * (y - 40); }) > 0.97);
  // Frequencies of a free square plate of Poisson's ratio 0.3 (Leissa 1973), for a diagonal of 1 and 0.3 % of it as thickness.
  const double frequency[] = {13.47, 19.60, 24.27, 34.80, 34.80};
  for (std::size_t k = 0; k < 5; ++k) {
    const double squared = std::pow(2 * frequency[k], 2) * 0.003 * 0.003 / 12;
    CHECK(modes.eigenvalue[k] == doctest::Approx(squared).epsilon(0.03));
  }
  for (const auto& mode : modes.displacement) {
    Vec3 sum{}, turn{};
    for (std::size_t v = 0; v < mode.size(); ++v) {
      // Vertices on the rim stand for less area than the others.
      const Vec3 p = mesh.position[v];
      const float weight = (p.x == 0 || p.x == 80 ? 0.5f : 1.0f) * (p.y == 0 || p.y == 80 ? 0.5f : 1.0f);
      sum = sum + weight * mode[v];
      turn = turn + weight * cross(p - Vec3{40, 40, 0}, mode[v]);
    }
    CHECK(length(sum) / 625 < 0.03f * static_cast<float>(rms(mode)));
    CHECK(length(turn) / 625 < 3 * static_cast<float>(rms(mode)));
    CHECK(stretch(mesh, mode) < 1e-4f);
  }
}

TEST_CASE("a card with faces on both sides and no thickness bends as one with faces on one side") {
  const BendingMesh one = plate(12, 8, 90, 60);
  const BendingModes expected = find_bending_modes(one, 4, 1);
  BendingMesh same = one, crossed = one;
  for (std::size_t f = 0; f < one.triangles.size(); f += 2) {
    const int a = one.triangles[f][0], b = one.triangles[f][1], c = one.triangles[f][2],
              d = one.triangles[f + 1][2];
    same.triangles.insert(same.triangles.end(), {{a, c, b}, {a, d, c}});
    crossed.triangles.insert(crossed.triangles.end(), {{b, a, d}, {b, d, c}});
  }
  const BendingModes as_cut = find_bending_modes(same, 4, 1), other_way = find_bending_modes(crossed, 4, 1);
  for (std::size_t k = 0; k < 4; ++k) {
    CAPTURE(k);
    CHECK(as_cut.eigenvalue[k] == doctest::Approx(expected.eigenvalue[k]).epsilon(1e-6));
    CHECK(other_way.eigenvalue[k] == doctest::Approx(expected.eigenvalue[k]).epsilon(0.3));
    CHECK(stretch(crossed, other_way.displacement[k]) < 0.02f);
  }
}

TEST_CASE("three leaves that meet in one line hold each other there") {
  constexpr int kColumns = 12, kRows = 6, kMiddle = 6;
  BendingMesh leaves = plate(kColumns, kRows, 120, 60);
  const double alone = find_bending_modes(leaves, 1, 1).eigenvalue[0];
  const auto vertex = [](int i, int j) {  // of the leaf that stands in the middle
    return i == 0 ? j * (kColumns + 1) + kMiddle : (kColumns + 1) * (kRows + 1) + j * kMiddle + i - 1;
  };
  for (int j = 0; j <= kRows; ++j)
    for (int i = 1; i <= kMiddle; ++i)
      leaves.position.push_back({60, 10 * static_cast<float>(j), 10 * static_cast<float>(i)});
  for (int j = 0; j < kRows; ++j)
    for (int i = 0; i < kMiddle; ++i) {
      const int a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i + 1, j + 1), d = vertex(i, j + 1);
      leaves.triangles.insert(leaves.triangles.end(), {{a, b, c}, {a, c, d}});
    }
  leaves.is_fixed.assign(leaves.position.size(), 0);
  CHECK(find_bending_modes(leaves, 1, 1).eigenvalue[0] > 0.1 * alone);
}

TEST_CASE("standard deviations come from the stiffness, with the same energy in each mode") {
  const BendingMesh mesh = plate(20, 12, 100, 50);
  const BendingModes soft = find_bending_modes(mesh, 5, 1), stiff = find_bending_modes(mesh, 5, 4);
  const double diagonal = std::sqrt(100.0 * 100 + 50 * 50);
  CHECK(rms(soft.displacement[0]) == doctest::Approx(0.05 * diagonal).epsilon(0.15));
  for (std::size_t k = 0; k < 5; ++k) {
    CHECK(rms(stiff.displacement[k]) == doctest::Approx(0.5 * rms(soft.displacement[k])).epsilon(1e-3));
    const double energy = soft.eigenvalue[k] * std::pow(rms(soft.displacement[k]), 2),
                 first = soft.eigenvalue[0] * std::pow(rms(soft.displacement[0]), 2);
    CHECK(energy ==
          doctest::Approx(first).epsilon(0.35));  // the mean over vertices is not that over the area
  }
}

TEST_CASE("modes of a curved sheet hardly stretch it, and two parts have modes each") {
  const BendingMesh tube = plate(30, 20, 120, 80, 50);
  for (const auto& mode : find_bending_modes(tube, 4, 1).displacement) CHECK(stretch(tube, mode) < 0.02f);
  BendingMesh two = plate(6, 6, 10, 10);
  const int n = static_cast<int>(two.position.size());
  for (int v = 0; v < n; ++v)
    two.position.push_back(two.position[static_cast<std::size_t>(v)] + Vec3{20, 0, 0});
  for (std::size_t f = two.triangles.size(); f > 0; --f) {
    const auto t = two.triangles[f - 1];
    two.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
  }
  two.is_fixed.assign(two.position.size(), 0);
  const BendingModes modes = find_bending_modes(two, 4, 1);
  REQUIRE(modes.eigenvalue.size() == 4);
  CHECK(modes.eigenvalue[0] == doctest::Approx(modes.eigenvalue[1]).epsilon(1e-3));
  CHECK(modes.eigenvalue[2] == doctest::Approx(modes.eigenvalue[3]).epsilon(1e-3));
  CHECK(modes.eigenvalue[2] > 1.3 * modes.eigenvalue[0]);
}

TEST_CASE("corrective shapes keep the lengths of a sheet that rolls up") {
  const BendingMesh strip = plate(40, 8, 100, 20);
  const BendingModes modes = find_bending_modes(strip, 3, 1);
  REQUIRE(modes.displacement.size() == 3);
  REQUIRE_FALSE(modes.corrections.empty());
  // Without the corrections the bend stretches the sheet.
  const auto worst_stretch = [&](bool corrects) {
    std::vector<Vec3> p = strip.position;
    const float q[] = {1, 0, 0};
    for (std::size_t v = 0; v < p.size(); ++v) {
      p[v] = p[v] + q[0] * modes.displacement[0][v];
      for (const ModeCorrection& c : modes.corrections)
        if (corrects) p[v] = p[v] + (q[c.first] * q[c.second]) * c.displacement[v];
    }
    float worst = 0;
    for (const auto& t : strip.triangles) {
      const auto a = static_cast<std::size_t>(t[0]), b = static_cast<std::size_t>(t[1]);
      worst = max(worst, magnitude(length(p[b] - p[a]) / length(strip.position[b] - strip.position[a]) - 1));
    }
    return worst;
  };
  CHECK(worst_stretch(false) > 0.05f);
  CHECK(worst_stretch(true) < 0.1f * worst_stretch(false));
}

TEST_CASE(
    "a correction belongs to two modes in order, is no rigid motion, and grows with the square of the "
    "modes") {
  const BendingMesh mesh = plate(20, 12, 100, 60);
  const BendingModes soft = find_bending_modes(mesh, 4, 1), stiff = find_bending_modes(mesh, 4, 4);
  REQUIRE_FALSE(soft.corrections.empty());
  CHECK(stiff.corrections.size() <= soft.corrections.size());  // small ones are left out
  for (const ModeCorrection& c : soft.corrections) {
    CHECK(c.first <= c.second);
    CHECK(c.second < 4);
    for (const Vec3 d : c.displacement) CHECK(magnitude(d.z) < 1e-3f);  // within the plane of a flat sheet
    for (const ModeCorrection& other : stiff.corrections)
      if (other.first == c.first && other.second == c.second)
        CHECK(rms(other.displacement) == doctest::Approx(0.25 * rms(c.displacement)).epsilon(1e-3));
  }
  BendingMesh held = mesh;
  for (std::size_t v = 0; v < held.position.size(); ++v) held.is_fixed[v] = held.position[v].x == 0;
  for (const ModeCorrection& c : find_bending_modes(held, 3, 1).corrections)
    for (std::size_t v = 0; v < held.position.size(); ++v)
      if (held.is_fixed[v]) CHECK(length(c.displacement[v]) == 0);
}

TEST_CASE("a surface with few vertices has few modes, one that is held whole has none") {
  BendingMesh mesh = plate(1, 1, 1, 1);
  CHECK(find_bending_modes(mesh, 50, 1).displacement.size() == 6);  // 12 unknowns, 6 rigid motions
  mesh.is_fixed.assign(4, 1);
  CHECK(find_bending_modes(mesh, 5, 1).displacement.empty());
}

TEST_CASE("what has no eigenvalues or no modes is said, not computed with") {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  Eigen::MatrixXd a = Eigen::MatrixXd::Identity(3, 3), b = a;
  CHECK(symmetric_eigen(a, b).values.size() == 3);
  b(2, 2) = -1;
  CHECK_THROWS_AS(symmetric_eigen(a, b), std::runtime_error);
  a(1, 0) = kNaN;
  CHECK_THROWS_AS(symmetric_eigen(a), std::runtime_error);
  CHECK_THROWS_AS(symmetric_eigen(a, Eigen::MatrixXd::Identity(3, 3)), std::runtime_error);
  CHECK_THROWS_AS(symmetric_eigen(Eigen::MatrixXd::Identity(3, 3), a), std::runtime_error);
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    BendingMesh mesh = plate(3, 3, 10, 10);
    mesh.position[5].z = bad;
    CHECK_THROWS_AS(find_bending_modes(mesh, 4, 1), std::runtime_error);
  }
}

}  // namespace bending_modes_test
