#include "host/bake/surface_boundary.hpp"

#include <algorithm>
#include <cmath>

#include "host/bake/at.hpp"
#include "host/bake/boundary_loops.hpp"

namespace pliant::host::bake {

namespace {

std::vector<char> triangles_inside(const Source& source, bool half) {
  std::vector<char> is_inside;
  for (std::size_t f = 0; f < source.triangles.size(); ++f) {
    const auto& t = source.triangles[f];
    const bool right =
        std::all_of(t.begin(), t.end(), [&](int v) { return source.uv[at(v)].x >= 0.5f - 1e-5f; });
    is_inside.push_back(!source.is_hole[f] && (right || !half));
  }
  return is_inside;
}

/// For each vertex of the boundary, the next one along it, else -1; and what lies beyond the edge between them.
struct BoundaryEdges {
  std::vector<int> next;
  std::vector<Side> side;
};

BoundaryEdges find_edges(const Source& source, const std::vector<char>& is_inside) {
  // Directed edges of the triangles inside, and which kinds of triangles have the same edge in the other direction. Sorted, not
  // kept in a map, which would take five times as long.
  enum : unsigned { kForth = 1, kBack = 2, kHole = 4, kOtherHalf = 8 };
  std::vector<std::pair<std::pair<int, int>, unsigned>> uses;
  for (std::size_t f = 0; f < source.triangles.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = source.triangles[f][k], b = source.triangles[f][(k + 1) % 3];
      if (is_inside[f]) uses.push_back({{a, b}, kForth});
      uses.push_back({{b, a}, is_inside[f] ? kBack : source.is_hole[f] ? kHole : kOtherHalf});
    }
  std::sort(uses.begin(), uses.end());
  BoundaryEdges edges{std::vector<int>(source.uv.size(), -1), std::vector<Side>(source.uv.size())};
  for (auto use = uses.begin(); use != uses.end();) {
    const auto [a, b] = use->first;
    unsigned all = 0;
    for (const auto edge = use->first; use != uses.end() && use->first == edge; ++use) all |= use->second;
    if ((all & kForth) == 0 || (all & kBack) != 0) continue;
    edges.next[at(a)] = b;
    edges.side[at(a)] = (all & kHole) != 0        ? Side::opening
                        : (all & kOtherHalf) != 0 ? Side::other_half
                                                  : Side::outside;
  }
  return edges;
}

}  // namespace

SurfaceBoundary find_boundary(const Source& source, bool half) {
  SurfaceBoundary boundary;
  boundary.is_inside = triangles_inside(source, half);
  BoundaryEdges edges = find_edges(source, boundary.is_inside);
  std::vector<std::pair<double, std::vector<int>>> by_area;
  for (auto& loop : trace_loops(std::move(edges.next))) {
    const double area = doubled_loop_area(source.uv, loop);
    by_area.emplace_back(area, std::move(loop));
  }
  std::sort(by_area.begin(), by_area.end(),
            [](const auto& a, const auto& b) { return std::fabs(a.first) > std::fabs(b.first); });
  for (auto& [area, vertices] : by_area) {
    BoundaryLoop loop;
    loop.is_hole = (area > 0) != (by_area[0].first > 0);
    for (const int v : vertices) loop.sides.push_back(loop.is_hole ? Side::opening : edges.side[at(v)]);
    loop.vertices = std::move(vertices);
    boundary.loops.push_back(std::move(loop));
  }
  return boundary;
}

}  // namespace pliant::host::bake
