// Loops of boundary edges, and which of them are openings.
#include "host/bake/boundary_loops.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "bake_sheet.hpp"
#include "host/bake/at.hpp"
#include "host/bake/surface_boundary.hpp"

namespace boundary_loops_test {

using namespace pliant;
using namespace pliant::host::bake;

namespace {

/// A sheet without its middle cell, whose corners lie at this place, so far apart.
Source pierced(Vec2 place, float width) {
  Source source = sheet(4, [](Vec2 uv) { return Vec3{100 * uv.x, -100 * uv.y, 0}; });
  const std::size_t middle = 2 * 4;  // the first triangle of cell (1,1)
  source.triangles.erase(source.triangles.begin() + middle, source.triangles.begin() + middle + 2);
  source.is_hole.resize(source.triangles.size());
  for (const std::size_t v : {5u, 6u, 9u, 10u})
    source.uv[v] = place + width * Vec2{v % 4 == 1 ? 0.0f : 1.0f, v < 8 ? 0.0f : 1.0f};
  return source;
}

}  // namespace

TEST_CASE("boundary edges are followed from vertex to vertex, the smallest first") {
  //                            0  1   2  3  4  5  6
  CHECK(trace_loops(std::vector<int>{4, 6, -1, 1, 5, 0, 3}) ==
        std::vector<std::vector<int>>{{0, 4, 5}, {1, 6, 3}});
  CHECK(trace_loops({-1, -1}).empty());
  CHECK(trace_loops({}).empty());
}

TEST_CASE("the area of a loop has the sign of its direction") {
  const std::vector<Vec2> uv{{0, 0}, {0, 1}, {1, 1}, {1, 0}};
  CHECK(doubled_loop_area(uv, {0, 3, 2, 1}) == 2);
  CHECK(doubled_loop_area(uv, {0, 1, 2, 3}) == -2);
  CHECK(doubled_loop_area(uv, {0, 1}) == 0);
}

TEST_CASE("an opening is known for one however small it is") {
  for (int k = 0; k < 40; ++k) {
    const float t = static_cast<float>(k) / 40;
    const Source source = pierced({0.6f + 0.3f * t, 0.9f - 0.2f * t}, 1e-5f);
    const SurfaceBoundary boundary = find_boundary(source, false);
    REQUIRE(boundary.loops.size() == 2);
    CHECK_FALSE(boundary.loops[0].is_hole);
    CHECK(boundary.loops[0].sides == std::vector<Side>(12, Side::outside));
    CHECK(boundary.loops[1].is_hole);
    CHECK(boundary.loops[1].sides == std::vector<Side>(4, Side::opening));
  }
}

}  // namespace boundary_loops_test
