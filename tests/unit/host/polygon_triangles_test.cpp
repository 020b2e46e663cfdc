// Polygons of a mesh as triangles: none without area where there is a way without.
#include "host/bake/polygon_triangles.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "host/bake/chart_raster.hpp"

namespace polygon_triangles_test {

using namespace pliant;
using namespace pliant::host::bake;

namespace {

struct Split {
  std::vector<std::array<int, 3>> triangles;
  float area = 0, least = 1e9f;  // twice those in the chart, of the polygon's winding
};

/// Splits the polygon of these points, which lies in space as in the chart unless `place` says otherwise.
Split split(
    const std::vector<Vec2>& uv, Vec3 (*place)(Vec2) = [](Vec2 p) {
      return Vec3{100 * p.x, 100 * p.y, 0};
    }) {
  std::vector<Vec3> position;
  for (const Vec2 p : uv) position.push_back(place(p));
  std::vector<int> corners(uv.size());
  std::iota(corners.begin(), corners.end(), 0);
  Split s;
  s.triangles = triangles_of(corners, uv, position);
  CHECK(s.triangles.size() == uv.size() - 2);
  float sign = 0;
  for (std::size_t k = 0; k < uv.size(); ++k) {
    const Vec2 a = uv[k], b = uv[(k + 1) % uv.size()];
    sign += a.x * b.y - a.y * b.x;
  }
  for (const float area : chart_areas(uv, s.triangles)) {
    const float own = sign < 0 ? -area : area;
    s.area += own;
    s.least = std::min(s.least, own);
  }
  CHECK(s.area == doctest::Approx(static_cast<double>(std::fabs(sign))).epsilon(1e-4));
  return s;
}

}  // namespace

TEST_CASE("a polygon whose fan is good keeps it: triangles, quads, regular polygons") {
  using Triangles = std::vector<std::array<int, 3>>;
  CHECK(split({{0, 0}, {1, 0}, {0, 1}}).triangles == Triangles{{0, 1, 2}});
  CHECK(split({{0, 0}, {1, 0}, {1, 1}, {0, 1}}).triangles == Triangles{{0, 1, 2}, {0, 2, 3}});
  CHECK(split({{0, 0}, {0, 1}, {1, 1}, {1, 0}}).triangles == Triangles{{0, 1, 2}, {0, 2, 3}});
  std::vector<Vec2> circle;
  for (int k = 0; k < 24; ++k)
    circle.push_back(
        {std::cos(0.2617994f * static_cast<float>(k)), std::sin(0.2617994f * static_cast<float>(k))});
  const Split fan = split(circle);
  for (const auto& t : fan.triangles) CHECK(t[0] == 0);
}

TEST_CASE("corners on a straight line get triangles with an area, also if the line is not quite straight") {
  for (const float off : {0.0f, 1e-7f, -1e-7f})
    for (std::size_t turn = 0; turn < 10; ++turn) {
      // Five corners along each long side of a strip.
      std::vector<Vec2> strip;
      for (int k = 0; k < 5; ++k) strip.push_back({0.25f * static_cast<float>(k), k == 2 ? off : 0});
      for (int k = 4; k >= 0; --k)
        strip.push_back({0.25f * static_cast<float>(k), 0.1f + (k == 1 ? off : 0)});
      std::rotate(strip.begin(), strip.begin() + static_cast<std::ptrdiff_t>(turn), strip.end());
      CHECK(split(strip).least > 0.01f);
    }
  // A triangle with a corner in the middle of each side, and one with two corners in one side.
  CHECK(split({{0, 0}, {0.5f, 0}, {1, 0}, {0.5f, 0.5f}, {0, 1}, {0, 0.5f}}).least > 0.2f);
  CHECK(split({{0, 0}, {0.3f, 0}, {0.6f, 0}, {1, 0}, {0, 1}}).least > 0.2f);
}

TEST_CASE("a concave polygon has triangles of one winding, with and without corners on a line") {
  CHECK(split({{0, 0}, {1, 0}, {1, 1}, {0.5f, 0.25f}, {0, 1}}).least > 0.1f);
  CHECK(split({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}, {0, 1}}).least > 0.5f);
  // A comb, of which no corner sees all others.
  std::vector<Vec2> comb{{0, 0}, {1, 0}};
  for (int k = 10; k >= 0; --k) comb.push_back({0.1f * static_cast<float>(k), k % 2 == 0 ? 1 : 0.2f});
  CHECK(split(comb).least > 0.001f);
}

TEST_CASE("the line may be one in space alone") {
  // The chart bends the lower side, which is straight in space.
  const auto straight = [](Vec2 p) { return Vec3{100 * p.x, p.y < 0.3f ? 0 : 100 * p.y, 0}; };
  std::vector<Vec3> position;
  const std::vector<Vec2> uv{{0, 0.2f}, {0.5f, 0}, {1, 0.2f}, {1, 1}, {0, 1}};
  for (const Vec2 p : uv) position.push_back(straight(p));
  for (const auto& t : split(uv, straight).triangles) {
    const auto at = [&](std::size_t k) { return position[static_cast<std::size_t>(t[k])]; };
    CHECK(length(cross(at(1) - at(0), at(2) - at(0))) > 100);
  }
}

TEST_CASE("more corners than are searched still give triangles that fill the polygon") {
  std::vector<Vec2> strip;
  for (int k = 0; k < 50; ++k) strip.push_back({0.02f * static_cast<float>(k), 0});
  for (int k = 49; k >= 0; --k) strip.push_back({0.02f * static_cast<float>(k), 0.1f});
  CHECK(split(strip).least >= 0);
}

}  // namespace polygon_triangles_test
