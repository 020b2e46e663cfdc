// The map to the chart is one to one if no triangle is inverted, the boundary neither touches nor crosses itself, and each
// boundary loop lies where its direction says: an outer loop outside all others or in a hole, a hole directly in its surface.
#include "host/bake/surface_check.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "host/bake/at.hpp"
#include "host/bake/boundary_loops.hpp"
#include "host/bake/chart_raster.hpp"
#include "host/bake/segment_grid.hpp"

namespace pliant::host::bake {

namespace {

/// Twice the area in the chart above which an inverted triangle is a defect: above the rounding error of six decimals.
constexpr float kInverted = 1e-9f;
/// Boundary loops, count, at most: a base mesh needs six vertices for each. Bounds the time.
constexpr std::size_t kMostLoops = 1000;

struct DirectedEdge {
  int from, to;
  std::size_t triangle;
};

class Checker {
 public:
  Checker(const std::vector<Vec2>& uv, const std::vector<std::array<int, 3>>& triangles)
      : uv_(uv), triangles_(triangles) {}

  std::optional<SurfaceDefect> run() {
    for (const auto check : {&Checker::check_triangles, &Checker::check_edges, &Checker::check_vertices,
                             &Checker::check_crossings, &Checker::check_nesting})
      if (auto defect = (this->*check)()) return defect;
    return {};
  }

 private:
  using Found = std::optional<SurfaceDefect>;

  Found check_triangles() {
    const auto areas = chart_areas(uv_, triangles_);
    for (std::size_t f = 0; f < areas.size(); ++f) {
      const auto& t = triangles_[f];
      if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0])
        return SurfaceDefect{"the face has the same corner twice", f};
      if (areas[f] > kInverted)
        return SurfaceDefect{
            "the chart has a fold-over at this face: its corners are reversed, its (u,v) are mirrored, "
            "or they wrap around",
            f};
    }
    return {};
  }

  Found check_edges() {
    for (std::size_t f = 0; f < triangles_.size(); ++f)
      for (std::size_t k = 0; k < 3; ++k) edges_.push_back({triangles_[f][k], triangles_[f][(k + 1) % 3], f});
    const auto low = [](const DirectedEdge& e) { return std::minmax(e.from, e.to); };
    std::sort(edges_.begin(), edges_.end(), [&](const DirectedEdge& a, const DirectedEdge& b) {
      return low(a) != low(b) ? low(a) < low(b) : a.triangle < b.triangle;
    });
    for (std::size_t i = 0; i < edges_.size();) {
      std::size_t end = i + 1;
      while (end < edges_.size() && low(edges_[end]) == low(edges_[i])) ++end;
      if (end - i > 2)
        return SurfaceDefect{"an edge of the face has " + std::to_string(end - i) + " faces",
                             edges_[i + 2].triangle};
      if (end - i == 2 && edges_[i].from == edges_[i + 1].from)
        return SurfaceDefect{"the face and its neighbour have opposite windings", edges_[i + 1].triangle};
      if (end - i == 1) boundary_.push_back(edges_[i]);
      i = end;
    }
    return {};
  }

  Found check_vertices() {
    for (const DirectedEdge& e : boundary_)
      if (!next_.insert({e.from, e}).second)
        return SurfaceDefect{"a corner of the face joins parts of the surface that share no edge",
                             e.triangle};
    if (boundary_.empty())
      return SurfaceDefect{"the chart overlaps itself: a closed surface needs a cut in u,v", 0};
    return {};
  }

  Found check_crossings() {
    std::vector<Segment> segments;
    for (const DirectedEdge& e : boundary_)
      segments.push_back({uv_[at(e.from)], uv_[at(e.to)], e.from, e.to});
    const auto crossing = SegmentGrid(segments).find_crossing();
    if (!crossing) return {};
    const Vec2 p = uv_[at(boundary_[crossing->first].from)];
    return SurfaceDefect{"the chart touches or overlaps itself near u " + std::to_string(p.x) + ", v " +
                             std::to_string(1 - p.y) + " of the file",
                         boundary_[crossing->first].triangle};
  }

  /// Loops do not cross here, so that one vertex of a loop tells where the whole of it lies.
  Found check_nesting() {
    std::vector<int> next(uv_.size(), -1);
    for (const auto& [from, e] : next_) next[at(from)] = e.to;
    const auto loops = trace_loops(std::move(next));
    if (loops.size() > kMostLoops)
      return SurfaceDefect{"the surface has " + std::to_string(loops.size()) +
                               " openings and parts, more than " + std::to_string(kMostLoops),
                           0};
    for (const std::vector<int>& loop : loops) {
      const Vec2 p = uv_[at(loop[0])];
      int winding = 0;
      for (const std::vector<int>& other : loops)
        if (other[0] != loop[0]) winding += winding_of(other, p);
      const bool is_hole = doubled_loop_area(uv_, loop) > 0;
      if (winding != (is_hole ? 1 : 0))
        return SurfaceDefect{"the chart overlaps itself: a part of the surface lies upon another",
                             next_.at(loop[0]).triangle};
    }
    return {};
  }

  /// Times that the loop runs around p; positive in the direction of an outer loop, which is clockwise.
  int winding_of(const std::vector<int>& loop, Vec2 p) const {
    int winding = 0;
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const Vec2 a = uv_[at(loop[k])], b = uv_[at(loop[(k + 1) % loop.size()])];
      if ((a.y > p.y) == (b.y > p.y)) continue;
      const double side = side_of(a, b, p);
      if (b.y > a.y && side > 0) --winding;
      if (b.y < a.y && side < 0) ++winding;
    }
    return winding;
  }

  const std::vector<Vec2>& uv_;
  const std::vector<std::array<int, 3>>& triangles_;
  std::vector<DirectedEdge> edges_, boundary_;
  std::map<int, DirectedEdge> next_;  // the boundary edge from a vertex
};

}  // namespace

std::optional<SurfaceDefect> find_defect(const std::vector<Vec2>& uv,
                                         const std::vector<std::array<int, 3>>& triangles) {
  return Checker(uv, triangles).run();
}

}  // namespace pliant::host::bake
