#include "host/bake/surface_boundary.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "host/bake/at.hpp"

namespace pliant::host::bake {

namespace {

double doubled_area(const Source& source, const BoundaryLoop& loop) {
  double sum = 0;
  for (std::size_t k = 0; k < loop.vertices.size(); ++k) {
    const Vec2 a = source.uv[at(loop.vertices[k])],
               b = source.uv[at(loop.vertices[(k + 1) % loop.vertices.size()])];
    sum += static_cast<double>(a.x * b.y - a.y * b.x);
  }
  return sum;
}

}  // namespace

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
  std::map<int, std::pair<int, Side>> next;
  for (auto use = uses.begin(); use != uses.end();) {
    const auto [a, b] = use->first;
    unsigned all = 0;
    for (const auto edge = use->first; use != uses.end() && use->first == edge; ++use) all |= use->second;
    if ((all & kForth) != 0 && (all & kBack) == 0)
      next[a] = {b, (all & kHole) != 0        ? Side::opening
                    : (all & kOtherHalf) != 0 ? Side::other_half
                                              : Side::outside};
  }
  while (!next.empty()) {
    BoundaryLoop loop;
    int v = next.begin()->first;
    for (auto step = next.find(v); step != next.end(); step = next.find(v)) {
      loop.vertices.push_back(v);
      loop.sides.push_back(step->second.second);
      v = step->second.first;
      next.erase(step);
    }
    boundary.loops.push_back(std::move(loop));
  }
  std::sort(boundary.loops.begin(), boundary.loops.end(), [&](const BoundaryLoop& a, const BoundaryLoop& b) {
    return std::fabs(doubled_area(source, a)) > std::fabs(doubled_area(source, b));
  });
  for (BoundaryLoop& loop : boundary.loops) {
    loop.is_hole = (doubled_area(source, loop) > 0) != (doubled_area(source, boundary.loops[0]) > 0);
    if (!loop.is_hole) continue;
    for (Side& s : loop.sides) s = Side::opening;
  }
  return boundary;
}

}  // namespace pliant::host::bake
