// Springs over lattices: every point is held, the springs hold together, and none leads through the air.
#include "host/bake/springs.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "host/bake/surface_distance.hpp"

namespace springs_test {

using namespace pliant;
using namespace pliant::host::bake;

namespace {

/// A flat sheet of n x m quads, 10 mm a side.
Source lattice(int n, int m) {
  Source source;
  for (int j = 0; j <= m; ++j)
    for (int i = 0; i <= n; ++i) {
      const float x = static_cast<float>(i), y = static_cast<float>(j);
      source.neutral.push_back({10 * x, 10 * y, 0});
      source.uv.push_back({x / static_cast<float>(n), y / static_cast<float>(m)});
    }
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i, b = a + 1, c = a + n + 2, d = a + n + 1;
      source.triangles.insert(source.triangles.end(), {{a, b, c}, {a, c, d}});
    }
  source.is_hole.assign(source.triangles.size(), 0);
  return source;
}

/// Parts into which the points fall if only springs join them.
std::size_t parts(const SourceSprings& springs) {
  std::vector<std::size_t> part(springs.points.size());
  for (std::size_t k = 0; k < part.size(); ++k) part[k] = k;
  for (std::size_t round = 0; round < part.size(); ++round)
    for (const auto& s : springs.springs)
      part[s.first] = part[s.second] = std::min(part[s.first], part[s.second]);
  std::size_t count = 0;
  for (std::size_t k = 0; k < part.size(); ++k) count += part[k] == k;
  return count;
}

}  // namespace

TEST_CASE("springs join all points of a lattice into one, at their distances") {
  for (const auto& size : {std::pair<int, int>{20, 14}, {12, 12}, {40, 28}, {63, 1}, {5, 5}, {2, 1}}) {
    const int n = size.first, m = size.second;  // no structured binding, which CAPTURE could not name
    CAPTURE(n);
    CAPTURE(m);
    const SourceSprings springs = make_springs(lattice(n, m), 0.03f);
    CHECK(parts(springs) == 1);
    std::vector<int> held(springs.points.size());
    for (const auto& s : springs.springs) {
      ++held[s.first], ++held[s.second];
      const Vec2 d = springs.points[s.first] - springs.points[s.second];
      const float x = 10 * static_cast<float>(n) * d.x, y = 10 * static_cast<float>(m) * d.y;
      CHECK(s.length_mm == doctest::Approx(static_cast<double>(square_root(x * x + y * y))));
      CHECK(s.sd_mm == doctest::Approx(0.03 * static_cast<double>(s.length_mm)));
    }
    CHECK(*std::min_element(held.begin(), held.end()) >= (m > 1 ? 2 : 1));
  }
}

namespace {

/// A sheet that is folded along its middle line: each leaf is turned by half of what `angle_deg` lacks to 180.
Source book(float angle_deg) {
  Source source = lattice(40, 28);
  const float half = 0.5f * angle_deg * 3.14159265f / 180;
  for (Vec3& p : source.neutral) {
    const float s = p.x - 200;
    p = {s * std::sin(half), p.y, std::fabs(s) * std::cos(half)};
  }
  return source;
}

/// Adds the other surface, moved, without joining vertices.
void add(const Source& other, Vec3 offset, Source& source) {
  const int first = static_cast<int>(source.uv.size());
  for (const Vec3 p : other.neutral) source.neutral.push_back(p + offset);
  source.uv.insert(source.uv.end(), other.uv.begin(), other.uv.end());
  for (const auto& t : other.triangles)
    source.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  source.is_hole.insert(source.is_hole.end(), other.is_hole.begin(), other.is_hole.end());
}

}  // namespace

TEST_CASE("no spring joins separate parts, however near they are") {
  Source source = lattice(20, 14);
  add(lattice(10, 10), {215, 20, 0}, source);  // 15 mm beside it
  for (std::size_t v = 0; v < source.uv.size(); ++v)
    source.uv[v].x = 0.4f * source.uv[v].x + (v < 21 * 15 ? 0.0f : 0.6f);
  const SourceSprings springs = make_springs(source, 0.03f);
  CHECK(parts(springs) == 2);
  for (const auto& s : springs.springs)
    CHECK((springs.points[s.first].x < 0.5f) == (springs.points[s.second].x < 0.5f));
}

TEST_CASE("no spring joins the two leaves of a fold through the air, and all of its points hold together") {
  for (const float angle : {30.0f, 50.0f, 90.0f}) {
    CAPTURE(angle);
    const SourceSprings springs = make_springs(book(angle), 0.03f);
    CHECK(parts(springs) == 1);
    for (const auto& s : springs.springs) {
      const Vec2 d = springs.points[s.first] - springs.points[s.second];
      CHECK(square_root(400 * d.x * 400 * d.x + 280 * d.y * 280 * d.y) <= 1.25f * s.length_mm);
    }
  }
}

TEST_CASE("no spring leads over an opening, whether triangles fill it or not") {
  Source frame = lattice(20, 20);  // 200 mm, with an opening of 100
  for (std::size_t f = 0; f < frame.triangles.size(); ++f) {
    Vec2 middle{};
    for (const int v : frame.triangles[f])
      middle = middle + (1.0f / 3) * frame.uv[static_cast<std::size_t>(v)];
    frame.is_hole[f] = std::max(std::fabs(middle.x - 0.5f), std::fabs(middle.y - 0.5f)) < 0.25f;
  }
  for (const bool is_filled : {true, false}) {
    CAPTURE(is_filled);
    Source source = frame;
    if (!is_filled) {
      source.triangles.clear();
      for (std::size_t f = 0; f < frame.triangles.size(); ++f)
        if (!frame.is_hole[f]) source.triangles.push_back(frame.triangles[f]);
      source.is_hole.assign(source.triangles.size(), 0);
    }
    const SourceSprings springs = make_springs(source, 0.03f);
    CHECK(springs.springs.size() > 20);
    for (const auto& s : springs.springs) {
      const Vec2 middle = 0.5f * (springs.points[s.first] + springs.points[s.second]);
      CHECK(std::max(std::fabs(middle.x - 0.5f), std::fabs(middle.y - 0.5f)) >= 0.2f);
    }
  }
}

TEST_CASE("springs lead over a cut of the chart") {
  Source source = lattice(10, 14);
  add(lattice(10, 14), {100, 0, 0}, source);  // whose vertices lie on those of the first
  CHECK(parts(make_springs(source, 0.03f)) == 1);
}

TEST_CASE("where no two points are neighbours there are no springs, and no points") {
  Source source;
  for (int k = 0; k < 30; ++k) {
    Source one = lattice(1, 1);
    add(one, {100 * static_cast<float>(k), 0, 0}, source);
  }
  const SourceSprings springs = make_springs(source, 0.03f);
  CHECK(springs.points.empty());
  CHECK(springs.springs.empty());
}

TEST_CASE("distances along a lattice are the straight ones to 8 %, and over a fold those of the flat sheet") {
  const Source flat = lattice(40, 28), folded = book(50);
  const std::size_t corner = 0, inner = 10 * 41 + 15;
  for (const std::size_t start : {corner, inner}) {
    const std::vector<float> over_flat = SurfaceDistance(flat).from(start),
                             over_fold = SurfaceDistance(folded).from(start);
    for (std::size_t v = 0; v < flat.uv.size(); ++v) {
      const float straight = length(flat.neutral[v] - flat.neutral[start]);
      CHECK(over_flat[v] >= straight * 0.9999f);
      CHECK(over_flat[v] <= straight * 1.083f);
      CHECK(over_fold[v] == doctest::Approx(static_cast<double>(over_flat[v])).epsilon(1e-4));
    }
  }
  Source apart = flat;
  add(flat, {1000, 0, 0}, apart);
  CHECK(SurfaceDistance(apart).from(0).back() == SurfaceDistance::kNoPath);
}

}  // namespace springs_test
