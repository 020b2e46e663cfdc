#include "host/bake/surface_boundary.hpp"

#include <algorithm>
#include <cmath>

#include "host/bake/at.hpp"
#include "host/bake/boundary_loops.hpp"

namespace pliant::host::bake {

SurfaceBoundary find_boundary(const Source& source, bool half) {
  SurfaceBoundary boundary;
  for (std::size_t f = 0; f < source.triangles.size(); ++f) {
    const auto& t = source.triangles[f];
    const bool right =
        std::all_of(t.begin(), t.end(), [&](int v) { return source.uv[at(v)].x >= 0.5f - 1e-5f; });
    boundary.is_inside.push_back(!source.is_hole[f] && (right || !half));
  }
  // Directed edges of the triangles inside, and which kinds of triangles have the same edge in the other direction. Sorted, not
  // kept in a map, which would take five times as long.
  enum : unsigned { kForth = 1, kBack = 2, kHole = 4, kOtherHalf = 8 };
  std::vector<std::pair<std::pair<int, int>, unsigned>> uses;
  for (std::size_t f = 0; f < source.triangles.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = source.triangles[f][k], b = source.triangles[f][(k + 1) % 3];
      if (boundary.is_inside[f]) uses.push_back({{a, b}, kForth});
      uses.push_back({{b, a}, boundary.is_inside[f] ? kBack : source.is_hole[f] ? kHole : kOtherHalf});
    }
  std::sort(uses.begin(), uses.end());
  std::vector<int> next(source.uv.size(), -1);  // along the boundary
  std::vector<Side> side(source.uv.size());     // of the edge from each vertex of the boundary
  for (auto use = uses.begin(); use != uses.end();) {
    const auto [a, b] = use->first;
    unsigned all = 0;
    for (const auto edge = use->first; use != uses.end() && use->first == edge; ++use) all |= use->second;
    if ((all & kForth) == 0 || (all & kBack) != 0) continue;
    next[at(a)] = b;
    side[at(a)] = (all & kHole) != 0        ? Side::opening
                  : (all & kOtherHalf) != 0 ? Side::other_half
                                            : Side::outside;
  }
  std::vector<std::pair<double, std::vector<int>>> by_area;
  for (auto& loop : trace_loops(std::move(next))) {
    const double area = doubled_loop_area(source.uv, loop);
    by_area.emplace_back(area, std::move(loop));
  }
  std::sort(by_area.begin(), by_area.end(),
            [](const auto& a, const auto& b) { return std::fabs(a.first) > std::fabs(b.first); });
  for (auto& [area, vertices] : by_area) {
    BoundaryLoop loop;
    loop.is_hole = (area > 0) != (by_area[0].first > 0);
    for (const int v : vertices) loop.sides.push_back(loop.is_hole ? Side::opening : side[at(v)]);
    loop.vertices = std::move(vertices);
    boundary.loops.push_back(std::move(loop));
  }
  return boundary;
}

}  // namespace pliant::host::bake
