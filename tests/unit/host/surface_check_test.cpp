// What makes a mesh no surface over a chart, and base meshes of surfaces that are awkward: each defect has a name.
#include "host/bake/surface_check.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "bake_sheet.hpp"
#include "host/bake/base_mesh.hpp"
#include "host/bake/chart_raster.hpp"
#include "host/bake/segment_grid.hpp"
#include "host/io/owned.hpp"
#include "pliant/mesh.hpp"
#include "random.hpp"

namespace surface_check_test {

using namespace pliant;
using namespace pliant::host::bake;

namespace {

Source flat(int n = 6) {
  return sheet(n, [](Vec2 uv) { return Vec3{100 * uv.x, -100 * uv.y, 0}; });
}

std::string defect_of(const Source& source) {
  const auto defect = find_defect(source.uv, source.triangles);
  return defect ? defect->what : "";
}

/// The square without the cells whose indices `is_gone` names.
template <class IsGone>
Source punched(int n, IsGone is_gone) {
  Source source = flat(n + 1);
  std::vector<std::array<int, 3>> kept;
  for (std::size_t f = 0; f < source.triangles.size(); ++f) {
    const int cell = static_cast<int>(f / 2);
    if (!is_gone(cell % n, cell / n)) kept.push_back(source.triangles[f]);
  }
  source.triangles = kept;
  source.is_hole.assign(kept.size(), 0);
  return source;
}

MeshStatistics checked_base_mesh(const Source& source, int vertices) {
  const BaseMesh mesh = make_base_mesh(source, vertices, false);
  REQUIRE(!mesh.corners.empty());
  MeshLimits limits;
  limits.vertices = static_cast<std::uint16_t>(mesh.uv.size());
  limits.faces = static_cast<std::uint16_t>(mesh.corners.size() / 3);
  host::Owned<Mesh> checked(limits);
  REQUIRE(checked->set_base({mesh.uv.data(), mesh.uv.size()}, {mesh.corners.data(), mesh.corners.size()}) ==
          Status::ok);
  CHECK(checked->validate().invariant == 0);
  return checked->compute_statistics();
}

}  // namespace

TEST_CASE("a sheet with and without a hole has no defect") {
  CHECK(defect_of(flat()) == "");
  CHECK(defect_of(punched(7, [](int i, int j) { return i == 3 && j == 3; })) == "");
}

TEST_CASE("each defect of a mesh has a name") {
  Source source = flat();
  SUBCASE("a face with a corner twice") {
    source.triangles[3][1] = source.triangles[3][0];
    CHECK(defect_of(source) == "the face has the same corner twice");
  }
  SUBCASE("a triangle that is turned over in the chart") {
    source.uv[14] = {0.9f, 0.9f};
    CHECK(defect_of(source).rfind("the chart has a fold-over at this face", 0) == 0);
  }
  SUBCASE("three faces at an edge") {
    source.uv.push_back({0.95f, 0.3f});
    source.triangles.push_back({source.triangles[9][0], source.triangles[9][1], 36});
    if (chart_areas(source.uv, {source.triangles.back()})[0] > 0)
      std::swap(source.triangles.back()[0], source.triangles.back()[1]);
    CHECK(defect_of(source) == "an edge of the face has 3 faces");
  }
  SUBCASE("parts that meet in a vertex only") {
    source = punched(4, [](int i, int j) { return (i == 1 && j == 1) || (i == 2 && j == 2); });
    CHECK(defect_of(source) == "a corner of the face joins parts of the surface that share no edge");
  }
  SUBCASE("a part upon another") {
    const Source copy = flat(3);
    for (const Vec2 uv : copy.uv) source.uv.push_back({0.3f + 0.2f * uv.x, 0.31f + 0.2f * uv.y});
    for (auto t : copy.triangles) source.triangles.push_back({t[0] + 36, t[1] + 36, t[2] + 36});
    CHECK(defect_of(source) == "the chart overlaps itself: a part of the surface lies upon another");
  }
  SUBCASE("parts that cross") {
    const Source copy = flat(3);
    for (Vec2& uv : source.uv) uv = 0.5f * uv;
    for (const Vec2 uv : copy.uv) source.uv.push_back({0.3f + 0.4f * uv.x, 0.31f + 0.4f * uv.y});
    for (auto t : copy.triangles) source.triangles.push_back({t[0] + 36, t[1] + 36, t[2] + 36});
    CHECK(defect_of(source).find("the chart touches or overlaps itself near u ") == 0);
  }
  SUBCASE("more openings than a base mesh can have") {
    CHECK(defect_of(punched(81, [](int i, int j) { return i % 2 == 1 && j % 2 == 1; })) ==
          "the surface has 1601 openings and parts, more than 1000");
  }
}

TEST_CASE("segments on a grid: the crossings found are those of a comparison of all pairs") {
  Random random(5);
  for (int trial = 0; trial < 60; ++trial) {
    std::vector<Segment> segments;
    const int n = 2 + random.below(60);
    const float reach = trial % 3 == 0 ? 1.0f : 0.05f;
    for (int k = 0; k < n; ++k) {
      const Vec2 a{random.uniform(0, 1), random.uniform(0, 1)};
      segments.push_back(
          {a, a + Vec2{random.uniform(-reach, reach), random.uniform(-reach, reach)}, 2 * k, 2 * k + 1});
    }
    std::vector<char> wanted(segments.size(), 0);
    for (std::size_t i = 0; i < segments.size(); ++i)
      for (std::size_t k = i + 1; k < segments.size(); ++k)
        if (touch(segments[i], segments[k])) wanted[i] = wanted[k] = 1;
    const SegmentGrid grid(segments);
    CHECK(grid.crossing_segments() == wanted);
    CHECK(grid.find_crossing().has_value() == (std::count(wanted.begin(), wanted.end(), 1) > 0));
  }
  CHECK(touch({{0, 0}, {1, 1}, 0, 1}, {{0.5f, 0.5f}, {1, 0}, 2, 3}));
  CHECK_FALSE(touch({{0, 0}, {1, 1}, 0, 1}, {{0.5f, 0.4f}, {1, 0}, 2, 3}));
  CHECK(covers_neighbour({{0, 0}, {1, 0}, 0, 1}, {{1, 0}, {0.5f, 0}, 1, 2}));
  CHECK_FALSE(covers_neighbour({{0, 0}, {1, 0}, 0, 1}, {{1, 0}, {2, 0}, 1, 2}));
}

TEST_CASE("base meshes of awkward surfaces have their topology") {
  SUBCASE("one triangle, with points inside it") {
    Source source;
    source.uv = {{0, 0}, {0, 1}, {1, 1}};
    source.neutral = {{0, 0, 0}, {0, -80, 0}, {80, -80, 0}};
    source.triangles = {{0, 1, 2}};
    source.is_hole = {0};
    const MeshStatistics s = checked_base_mesh(source, 200);
    CHECK(s.euler == 1);
    CHECK(s.vertices > 150);
    CHECK(s.vertices < 220);
    CHECK(s.largest_valence <= 9);
  }
  SUBCASE("a sieve of 100 openings that are narrower than the mesh's edges") {
    const MeshStatistics s =
        checked_base_mesh(punched(21, [](int i, int j) { return i % 2 == 1 && j % 2 == 1; }), 100);
    CHECK(s.euler == 1 - 100);
    CHECK(s.boundary_loops == 101);
  }
  SUBCASE("a comb") {
    const MeshStatistics s =
        checked_base_mesh(punched(41, [](int i, int j) { return i % 2 == 1 && j > 1; }), 150);
    CHECK(s.euler == 1);
    CHECK(s.boundary_loops == 1);
  }
  SUBCASE("two parts, one of them in an opening of the other") {
    const auto is_gone = [](int i, int j) {
      const int rim = std::max(std::abs(i - 10), std::abs(j - 10));
      return rim > 4 && rim < 8;
    };
    const MeshStatistics s = checked_base_mesh(punched(21, is_gone), 200);
    CHECK(s.euler == 1);  // a disc and an annulus
    CHECK(s.boundary_loops == 3);
  }
  SUBCASE("sizes from a tenth of a millimetre to a hundred metres") {
    for (const float scale : {1e-3f, 1.0f, 1e3f}) {
      Source source = flat(30);
      for (Vec3& p : source.neutral) p = scale * p;
      const MeshStatistics s = checked_base_mesh(source, 300);
      CHECK(s.vertices > 270);
      CHECK(s.vertices < 330);
    }
  }
}

}  // namespace surface_check_test
