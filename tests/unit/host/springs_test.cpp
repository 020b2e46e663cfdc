// Springs over lattices: every point is held, and the springs hold together.
#include "host/bake/springs.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

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

}  // namespace springs_test
