// What the baker does with meshes: subdivision, triangulation of a domain, base meshes, rasters, relaxed charts.
#include <doctest/doctest.h>

#include <cmath>

#include "bake_sheet.hpp"
#include "host/bake/base_mesh.hpp"
#include "host/bake/chart_raster.hpp"
#include "host/bake/chart_relaxation.hpp"
#include "host/bake/subdivision.hpp"
#include "host/bake/triangulation.hpp"
#include "host/io/owned.hpp"
#include "pliant/mesh.hpp"
#include "pliant/tracker_limits.hpp"
#include "pliant/visibility.hpp"
#include "random.hpp"

namespace bake_mesh_test {

using namespace pliant;
using namespace pliant::host::bake;

TEST_CASE("subdivision keeps a flat cage flat, and its weights add up to one") {
  Cage cage;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) {
      cage.names.push_back(std::to_string(4 * j + i));
      cage.position.push_back({static_cast<float>(i), static_cast<float>(j), 0});
      cage.mirror.push_back(4 * j + i);
    }
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) {
      const int a = 4 * j + i;
      cage.faces.push_back({{a, a + 4, a + 5, a + 1}, i == 1 && j == 1, "patch"});
    }
  const SubdividedCage fine = subdivide(cage, 3);
  CHECK(fine.quads.size() == 9 * 64);
  for (const Stencil& s : fine.stencils) {
    float sum = 0;
    for (const auto& [point, weight] : s) sum += weight;
    CHECK(std::fabs(sum - 1) < 1e-5f);
  }
  for (const Vec3 p : fine_values(fine, cage.position)) CHECK(p.z == 0);

  SUBCASE(
      "surface and openings are separated by a sharp edge: moving the opening's far side leaves the surface "
      "as it is") {
    // Around the hole (the middle quad) nothing but its own corners counts.
    auto lifted = cage.position;
    lifted[0].z = 1;
    const auto values = fine_values(fine, lifted);
    CHECK(values[5].z == 0);
  }
  SUBCASE("controls can be found for which the surface passes through the points, still ones excepted") {
    std::vector<float> targets(16, 0.0f);
    targets[5] = 1;
    targets[9] = -2;
    std::vector<char> is_still(16, 1);
    is_still[5] = is_still[9] = 0;
    const auto controls = controls_through(fine, targets, 12, is_still);
    const auto values = fine_values(fine, controls);
    CHECK(std::fabs(values[5] - 1) < 1e-3f);
    CHECK(std::fabs(values[9] + 2) < 1e-3f);
    CHECK(controls[0] == 0);
  }
  SUBCASE("a path follows the edges of the cage") {
    CHECK(path_through(fine, {0, 1, 2}).size() == 2 * 8 + 1);
    CHECK(path_through(fine, {2, 1}).front() == 2);
    CHECK(path_through(fine, {0, 15}).size() == 2);  // no edge between them
  }
}

TEST_CASE("a raster reproduces functions linear over the chart, also outside the mesh") {
  Source source = sheet(9, [](Vec2 uv) { return Vec3{3 * uv.x, uv.y - 2 * uv.x, 1}; });
  for (Vec2& uv : source.uv) uv = {0.2f + 0.6f * uv.x, 0.3f + 0.5f * uv.y};
  const ChartRaster raster = rasterise(source.uv, source.triangles, source.is_hole, 41, 31);
  for (int j = 0; j < 31; ++j)
    for (int i = 0; i < 41; ++i) {
      const float u = (static_cast<float>(i) / 40 - 0.2f) / 0.6f,
                  v = (static_cast<float>(j) / 30 - 0.3f) / 0.5f;
      const float beyond = max(max(-u, u - 1) * 0.6f * 40, max(-v, v - 1) * 0.5f * 30);  // in samples
      if (beyond > 0.99f) continue;
      const Vec3 p = value_at(raster.at(i, j), source.neutral);
      CHECK(length(p - Vec3{3 * u, v - 2 * u, 1}) < 1e-3f);
      CHECK((raster.at(i, j).triangle >= 0) == (beyond <= 1e-3f));
    }
}

TEST_CASE(
    "a part with large triangles goes on beyond its boundary as itself, not as a part with small ones near "
    "by") {
  Source source = sheet(2, [](Vec2) { return Vec3{1, 0, 0}; });
  const Source fine = sheet(17, [](Vec2) { return Vec3{0, 100, 0}; });
  for (Vec2& uv : source.uv) uv = {0.1f + 0.8f * uv.x, 0.1f + 0.4f * uv.y};
  const auto first = static_cast<int>(source.uv.size());
  for (std::size_t v = 0; v < fine.uv.size(); ++v) {
    source.uv.push_back({0.1f + 0.8f * fine.uv[v].x, 0.6f + 0.3f * fine.uv[v].y});
    source.neutral.push_back(fine.neutral[v]);
  }
  for (const auto& t : fine.triangles) source.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  source.is_hole.assign(source.triangles.size(), 0);
  const ChartRaster raster = rasterise(source.uv, source.triangles, source.is_hole, 41, 41);
  for (int i = 3; i <= 37; ++i) {
    CAPTURE(i);
    CHECK(length(value_at(raster.at(i, 21), source.neutral) - Vec3{1, 0, 0}) < 1e-3f);
    CHECK(length(value_at(raster.at(i, 23), source.neutral) - Vec3{0, 100, 0}) < 1e-2f);
  }
}

TEST_CASE("a triangulation contains its loops, covers the domain once and has no inverted triangle") {
  Random random(7);
  for (int trial = 0; trial < 20; ++trial) {
    Domain domain;
    const auto circle = [&](int n, float radius) {
      std::vector<int> loop;
      for (int k = 0; k < n; ++k) {
        const float a = 6.2831853f * static_cast<float>(k) / static_cast<float>(n),
                    r = radius * random.uniform(0.8f, 1);
        loop.push_back(static_cast<int>(domain.points.size()));
        domain.points.push_back({0.5f + r * std::cos(a), 0.5f + r * std::sin(a)});
      }
      domain.loops.push_back(loop);
    };
    circle(25, 0.45f);
    circle(9 + trial % 7, 0.15f);
    for (int k = 0; k < 60; ++k) {
      const float a = random.uniform(0, 6.28f), r = random.uniform(0.17f, 0.35f);
      domain.points.push_back({0.5f + r * std::cos(a), 0.5f + r * std::sin(a)});
    }
    Triangles triangles = triangulate(domain);
    std::vector<Vec3> position;
    for (Vec2 p : domain.points) position.push_back({p.x, 3 * p.y, p.x * p.y});
    const auto check = [&] {
      const std::size_t n = domain.points.size();
      CHECK(triangles.size() == n + n - domain.loops[0].size() - domain.loops[1].size());  // Euler, one hole
      double area = 0, wanted = 0;
      for (float a : chart_areas(domain.points, triangles)) {
        CHECK(a > 0);
        area += static_cast<double>(a);
      }
      for (std::size_t l = 0; l < 2; ++l)
        for (std::size_t k = 0; k < domain.loops[l].size(); ++k) {
          const Vec2 a = domain.points[static_cast<std::size_t>(domain.loops[l][k])];
          const Vec2 b =
              domain.points[static_cast<std::size_t>(domain.loops[l][(k + 1) % domain.loops[l].size()])];
          wanted += (l == 0 ? 1.0 : -1.0) * static_cast<double>(a.x * b.y - a.y * b.x);
        }
      CHECK(area == doctest::Approx(wanted).epsilon(1e-4));
    };
    check();
    flip_by_shape(triangles, domain.points, position);
    check();
  }
  Domain crossing{{{0, 0}, {1, 1}, {1, 0}, {0, 1}}, {{0, 1, 2, 3}}};
  CHECK(triangulate(crossing).empty());
}

TEST_CASE("a base mesh has about the vertices asked for, follows an opening and is of basic blocks") {
  Source source = sheet(65, dome);
  for (std::size_t f = 0; f < source.triangles.size(); ++f)
    source.is_hole[f] =
        length(source.uv[static_cast<std::size_t>(source.triangles[f][0])] - Vec2{0.5f, 0.5f}) < 0.15f;
  source.landmarks = {{"one", {0.21f, 0.3f}}, {"near it", {0.22f, 0.3f}}, {"in the hole", {0.5f, 0.5f}}};
  for (const bool symmetric : {false, true})
    for (const int wanted : {100, 300}) {
      const BaseMesh mesh = make_base_mesh(source, wanted, symmetric);
      CHECK(mesh.uv.size() > 0.8 * wanted);
      CHECK(mesh.uv.size() < 1.25 * wanted);
      const auto closest = [&](Vec2 p) {
        float least = 1;
        for (Vec2 q : mesh.uv) least = min(least, length(p - q));
        return least;
      };
      if (!symmetric) CHECK(closest({0.21f, 0.3f}) < 1e-6f);
      CHECK(closest({0.5f, 0.5f}) > 0.1f);
      host::Owned<Mesh> checked(MeshLimits{});
      REQUIRE(checked->set_base({mesh.uv.data(), mesh.uv.size()},
                                {mesh.corners.data(), mesh.corners.size()}) == Status::ok);
      CHECK(checked->compute_statistics().boundary_loops == 2);
      CHECK(checked->compute_statistics().euler == 0);
    }
}

TEST_CASE("a plain grid, whose points lie on common lines and circles, gets a base mesh of the whole chart") {
  for (const int n : {3, 4, 7, 20, 33})
    for (const int wanted : {60, 150, 480}) {
      CAPTURE(n);
      CAPTURE(wanted);
      Source source = sheet(n, [](Vec2 uv) { return Vec3{190 * uv.x, -190 * uv.y, 0}; });
      const BaseMesh mesh = make_base_mesh(source, wanted, false);
      REQUIRE(!mesh.corners.empty());
      host::Owned<Mesh> checked(MeshLimits{});
      REQUIRE(checked->set_base({mesh.uv.data(), mesh.uv.size()},
                                {mesh.corners.data(), mesh.corners.size()}) == Status::ok);
      CHECK(checked->compute_statistics().boundary_loops == 1);
      CHECK(checked->compute_statistics().euler == 1);
      double area = 0;
      for (std::size_t f = 0; f < mesh.corners.size(); f += 3) {
        const float twice = -doubled_area(mesh.uv[mesh.corners[f]], mesh.uv[mesh.corners[f + 1]],
                                          mesh.uv[mesh.corners[f + 2]]);
        CHECK(twice > 0);
        area += 0.5 * static_cast<double>(twice);
      }
      CHECK(area <= 1.00001);
      CHECK(area > 0.98);  // the boundary is resampled: points near the corners of the chart cut them off
    }
}

TEST_CASE(
    "a bent grid, whose points come in rows at once, gets no more vertices than the limits of a tracker "
    "have") {
  for (int n = 9; n <= 41; n += 2) {
    CAPTURE(n);
    const Source source = sheet(n, [](Vec2 uv) {
      const float angle = 2 * uv.x - 1;
      return Vec3{150 * std::sin(angle), 300 * (0.5f - uv.y), 150 * std::cos(angle) - 150};
    });
    const std::size_t vertices = make_base_mesh(source, 480, false).uv.size();
    CHECK(vertices > 240);
    CHECK(vertices <= TrackerLimits{}.vertices);
  }
}

namespace {

/// A flat square of 20 x 20 mm whose chart crushes a disc in its middle to a twentieth, with a hole beside it.
Source crushed_sheet() {
  Source source = sheet(41, [](Vec2 uv) { return Vec3{20 * uv.x, -20 * uv.y, 0}; });
  for (Vec2& uv : source.uv) {
    const Vec2 arm = uv - Vec2{0.5f, 0.5f};
    const float r = length(arm);
    const float crushed = r < 0.2f ? 0.05f * r : r < 0.4f ? 0.01f + (r - 0.2f) * 0.39f / 0.2f : r;
    uv = Vec2{0.5f, 0.5f} + (r > 0 ? crushed / r : 0.0f) * arm;
    uv = Vec2{0.3f, 0.2f} + 0.5f * uv;
  }
  std::vector<std::array<int, 3>> kept;
  for (const auto& t : source.triangles) {
    const Vec3 p = source.neutral[static_cast<std::size_t>(t[0])];
    if (p.x < 1.4f || p.x > 3.1f || p.y > -1.4f || p.y < -3.1f) kept.push_back(t);
  }
  source.triangles = kept;
  return source;
}

/// Root mean square of the surface's stretch over the chart (Sander and others 2001), millimetres per chart unit. Its lower bound
/// is the square root of the surface's area over the chart's area.
double chart_stretch(const Source& source) {
  double sum = 0, area = 0;
  for (const auto& t : source.triangles) {
    const auto corner = [&t](std::size_t k) { return static_cast<std::size_t>(t[k]); };
    const Vec2 a = source.uv[corner(0)], e = source.uv[corner(1)] - a, f = source.uv[corner(2)] - a;
    const Vec3 p = source.neutral[corner(0)], d = source.neutral[corner(1)] - p,
               g = source.neutral[corner(2)] - p;
    // Derivatives of the surface by u and v: d = e.x pu + e.y pv, g = f.x pu + f.y pv.
    const float twice = e.x * f.y - e.y * f.x;
    const Vec3 pu = (1 / twice) * (f.y * d - e.y * g), pv = (1 / twice) * (e.x * g - f.x * d);
    const double face_area = 0.5 * double(length(cross(d, g)));
    sum += 0.5 * double(dot(pu, pu) + dot(pv, pv)) * face_area;
    area += face_area;
  }
  return std::sqrt(sum / area);
}

}  // namespace

TEST_CASE(
    "relaxing a chart gives crushed parts room, turns no triangle over and leaves boundaries in their "
    "place") {
  Source source = crushed_sheet();
  const auto before = source.uv;
  const double crushed = chart_stretch(source);
  relax_chart(source.uv, source.neutral, source.triangles);
  const double relaxed = chart_stretch(source);
  const double least = 20 / (1 - 2.0 / 64);  // a square of 20 mm evenly over the chart
  CHECK(crushed > 5 * least);
  CHECK(relaxed < 1.05 * least);
  CHECK(relaxed > 0.99 * least);
  float smallest = 1;
  for (const float area : chart_areas(source.uv, source.triangles)) {
    CHECK(area < 0);
    smallest = min(smallest, -area);
  }
  CHECK(smallest > 0.2f / (40 * 40));
  for (const std::size_t corner : {0u, 40u, 1640u, 1680u}) {
    const Vec2 was = before[corner], is = source.uv[corner];
    CHECK(length(is - Vec2{(was.x - 0.3f) / 0.5f, (was.y - 0.2f) / 0.5f}) < 0.03f);
  }
  const auto inside_hole = [](Vec2 p) { return p.x > 0.1f && p.x < 0.17f && p.y > 0.1f && p.y < 0.17f; };
  for (const auto& t : source.triangles) {
    const Vec2 centre =
        (1.0f / 3) * (source.uv[static_cast<std::size_t>(t[0])] + source.uv[static_cast<std::size_t>(t[1])] +
                      source.uv[static_cast<std::size_t>(t[2])]);
    CHECK_FALSE(inside_hole(centre));
  }
}

TEST_CASE("a chart that is already even does not change") {
  Source source = sheet(21, [](Vec2 uv) { return Vec3{10 * uv.x, -10 * uv.y, 0}; });
  relax_chart(source.uv, source.neutral, source.triangles);
  for (std::size_t v = 0; v < source.uv.size(); ++v) {
    const Vec3 p = source.neutral[v];
    const Vec2 even{1.0f / 64 + 0.1f * p.x * (1 - 2.0f / 64), 1.0f / 64 - 0.1f * p.y * (1 - 2.0f / 64)};
    CHECK(length(source.uv[v] - even) < 1e-3f);
  }
}

}  // namespace bake_mesh_test
