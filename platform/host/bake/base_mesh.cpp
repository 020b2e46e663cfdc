// Points first (along the boundary, landmarks, then as far from each other as the number allows), then
// triangles over them in the chart, then both are relaxed by turns: points towards the middle of their star,
// edges by shape in space.
#include "host/bake/base_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "host/bake/at.hpp"
#include "host/bake/chart_raster.hpp"
#include "host/bake/field_grid.hpp"
#include "host/bake/surface_boundary.hpp"
#include "host/bake/triangulation.hpp"
#include "host/io/owned.hpp"
#include "pliant/base_mesh.hpp"

namespace pliant::host::bake {

namespace {

class BaseMesher {
 public:
  BaseMesher(const Source& source, bool is_symmetric)
      : source_(source), is_symmetric_(is_symmetric), boundary_(find_boundary(source, is_symmetric)) {
    const ChartRaster raster = rasterise(source.uv, source.triangles, source.is_hole, kSide, kSide);
    shape_ = grid_of(raster, source.neutral);
    for (const BoundaryLoop& loop : boundary_.loops)
      for (std::size_t k = 0; k < loop.vertices.size(); ++k)
        if (loop.sides[k] == Side::opening) openings_.push_back(source.neutral[at(loop.vertices[k])]);
    shuffle_candidates();
  }

  BaseMesh run(int vertices) {
    // Without symmetry the count is of the whole, with it of one half and the middle.
    const double wanted = is_symmetric_ ? 0.52 * vertices : vertices;
    double low = 1, high = 100;
    for (int round = 0; round < 14; ++round) {
      edge_ = static_cast<float>(std::sqrt(low * high));
      place_points();
      (static_cast<double>(domain_.points.size()) > wanted ? low : high) = static_cast<double>(edge_);
    }
    triangles_ = triangulate(domain_);
    if (triangles_.empty()) return {};
    for (int round = 0; round < 40; ++round) relax();
    return paired();
  }

 private:
  static constexpr int kSide = 257;

  Vec3 position(Vec2 uv) const {
    return {sample(shape_, 0, uv), sample(shape_, 1, uv), sample(shape_, 2, uv)};
  }

  /// Wanted length of edges at a place.
  float edge_at(Vec3 p) const {
    float nearest = 1e9f;
    for (Vec3 o : openings_) nearest = std::min(nearest, dot(p - o, p - o));
    return std::min(edge_, 0.5f * edge_ + 0.35f * std::sqrt(nearest));
  }

  void shuffle_candidates() {
    std::vector<char> usable(source_.uv.size(), 0);
    for (std::size_t f = 0; f < source_.triangles.size(); ++f)
      for (int v : source_.triangles[f]) usable[at(v)] |= boundary_.is_inside[f];
    for (const BoundaryLoop& loop : boundary_.loops)
      for (int v : loop.vertices) usable[at(v)] = 0;
    for (std::size_t v = 0; v < usable.size(); ++v)
      if (usable[v]) candidates_.push_back(static_cast<int>(v));
    std::uint32_t state = 12345;  // a fixed order that follows nothing on the surface
    for (std::size_t k = candidates_.size(); k > 1; --k) {
      state = state * 1664525u + 1013904223u;
      std::swap(candidates_[k - 1], candidates_[(state >> 8) % k]);
    }
  }

  int add_point(Vec2 uv, bool is_fixed) {
    if (is_symmetric_ && magnitude(uv.x - 0.5f) < 1e-5f) uv.x = 0.5f;  // exactly in the middle, to be shared
    domain_.points.push_back(uv);
    positions_.push_back(position(uv));
    is_fixed_.push_back(is_fixed);
    return static_cast<int>(domain_.points.size()) - 1;
  }

  bool is_free_at(Vec3 p, float distance) const {
    return std::none_of(positions_.begin(), positions_.end(),
                        [&](Vec3 q) { return dot(p - q, p - q) < distance * distance; });
  }

  void place_points() {
    domain_ = {};
    positions_.clear();
    is_fixed_.clear();
    for (const BoundaryLoop& loop : boundary_.loops) place_loop(loop);
    for (const SourceLandmark& l : source_.landmarks) {
      if (is_symmetric_ && l.uv.x < 0.5f) continue;
      const Vec3 p = position(l.uv);
      if (is_inside(l.uv) && is_free_at(p, 0.5f * edge_at(p))) add_point(l.uv, true);
    }
    for (int v : candidates_) {
      const Vec3 p = source_.neutral[at(v)];
      if (is_free_at(p, 0.83f * edge_at(p))) add_point(source_.uv[at(v)], false);
    }
  }

  /// By winding: the place is within the outer loop and in no other.
  bool is_inside(Vec2 p) const {
    bool inside = false;
    for (const BoundaryLoop& loop : boundary_.loops)
      for (std::size_t k = 0; k < loop.vertices.size(); ++k) {
        const Vec2 a = source_.uv[at(loop.vertices[k])],
                   b = source_.uv[at(loop.vertices[(k + 1) % loop.vertices.size()])];
        if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x))
          inside = !inside;
      }
    return inside;
  }

  /// Vertices of the loop that must be kept: where its kind changes, and next to landmarks.
  std::vector<char> anchors(const BoundaryLoop& loop) const {
    const std::size_t n = loop.vertices.size();
    std::vector<char> is_anchor(n, 0);
    for (std::size_t k = 0; k < n; ++k) is_anchor[k] = loop.sides[k] != loop.sides[(k + n - 1) % n];
    for (const SourceLandmark& l : source_.landmarks) {
      std::size_t best = 0;
      for (std::size_t k = 0; k < n; ++k)
        if (length(source_.uv[at(loop.vertices[k])] - l.uv) <
            length(source_.uv[at(loop.vertices[best])] - l.uv))
          best = k;
      constexpr float kOnLoop = 0.003f, kApart = 0.015f;
      const Vec2 here = source_.uv[at(loop.vertices[best])];
      bool is_near_another = false;
      for (std::size_t k = 0; k < n; ++k)
        is_near_another |= is_anchor[k] && length(source_.uv[at(loop.vertices[k])] - here) < kApart;
      if (length(here - l.uv) < kOnLoop && !is_near_another) is_anchor[best] = 1;
    }
    if (std::count(is_anchor.begin(), is_anchor.end(), 1) == 0) is_anchor[0] = 1;
    return is_anchor;
  }

  void place_loop(const BoundaryLoop& loop) {
    const std::size_t n = loop.vertices.size();
    const std::vector<char> is_anchor = anchors(loop);
    const std::size_t first =
        static_cast<std::size_t>(std::find(is_anchor.begin(), is_anchor.end(), 1) - is_anchor.begin());
    std::vector<int> placed;
    for (std::size_t start = first; start < first + n;) {
      std::size_t end = start + 1;
      while (!is_anchor[end % n]) ++end;
      place_run(loop, start, end, placed);
      start = end;
    }
    domain_.loops.push_back(placed);
  }

  /// Points from one anchor to before the next, spread so that each step is as long as is wanted there.
  void place_run(const BoundaryLoop& loop, std::size_t start, std::size_t end, std::vector<int>& placed) {
    const std::size_t n = loop.vertices.size();
    const auto vertex = [&](std::size_t k) { return loop.vertices[k % n]; };
    std::vector<float> steps{0};  // along the run, in wanted lengths
    for (std::size_t k = start; k < end; ++k) {
      const Vec3 a = source_.neutral[at(vertex(k))], b = source_.neutral[at(vertex(k + 1))];
      steps.push_back(steps.back() + length(b - a) / edge_at(0.5f * (a + b)));
    }
    const bool whole_loop = end - start == n;
    const int pieces = std::max(whole_loop ? 6 : 1, static_cast<int>(std::lround(steps.back())));
    for (int piece = 0; piece < pieces; ++piece) {
      const float wanted = steps.back() * static_cast<float>(piece) / static_cast<float>(pieces);
      const std::size_t k =
          static_cast<std::size_t>(std::upper_bound(steps.begin(), steps.end() - 1, wanted) - steps.begin()) -
          1;
      const float share = (wanted - steps[k]) / std::max(1e-9f, steps[k + 1] - steps[k]);
      const Vec2 a = source_.uv[at(vertex(start + k))], b = source_.uv[at(vertex(start + k + 1))];
      placed.push_back(add_point(a + share * (b - a), true));
    }
  }

  /// Moves each free point to the middle of its star, weighted by area on the surface over the wanted area,
  /// where that turns no triangle over; then flips edges.
  void relax() {
    std::vector<std::vector<std::size_t>> star(domain_.points.size());
    for (std::size_t f = 0; f < triangles_.size(); ++f)
      for (int v : triangles_[f]) star[at(v)].push_back(f);
    for (std::size_t v = 0; v < star.size(); ++v) {
      if (is_fixed_[v] || star[v].empty()) continue;
      Vec2 sum{0, 0};
      float total = 0;
      for (std::size_t f : star[v]) {
        const auto& t = triangles_[f];
        const Vec3 a = positions_[at(t[0])], b = positions_[at(t[1])], c = positions_[at(t[2])];
        const float wanted = edge_at((1.0f / 3) * (a + b + c));
        const float weight = length(cross(b - a, c - a)) / (wanted * wanted);
        sum = sum +
              (weight / 3) * (domain_.points[at(t[0])] + domain_.points[at(t[1])] + domain_.points[at(t[2])]);
        total += weight;
      }
      const Vec2 before = domain_.points[v];
      domain_.points[v] = (1 / total) * sum;
      if (turns_over(star[v])) domain_.points[v] = before;
      positions_[v] = position(domain_.points[v]);
    }
    flip_by_shape(triangles_, domain_.points, positions_);
  }

  bool turns_over(const std::vector<std::size_t>& star) const {
    return std::any_of(star.begin(), star.end(), [&](std::size_t f) {
      const Vec2 a = domain_.points[at(triangles_[f][0])], b = domain_.points[at(triangles_[f][1])],
                 c = domain_.points[at(triangles_[f][2])];
      return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) <= 1e-7f;
    });
  }

  BaseMesh paired() const {
    std::vector<std::uint16_t> corners;
    for (const auto& t : triangles_)
      for (int v : t) corners.push_back(static_cast<std::uint16_t>(v));
    BaseMeshLimits limits;
    limits.vertices = static_cast<std::uint16_t>(domain_.points.size());
    limits.faces = static_cast<std::uint16_t>(triangles_.size());
    limits.splits = false;
    Owned<BaseMeshMaker> maker(limits);
    const Span<const Vec2> uv{domain_.points.data(), domain_.points.size()};
    const Span<const Vec3> positions{positions_.data(), positions_.size()};
    if (maker->by_pairing(uv, {corners.data(), corners.size()}, Winding::clockwise, positions) != Status::ok)
      return {};
    BaseMesh mesh{{maker->uv().begin(), maker->uv().end()},
                  {maker->corners().begin(), maker->corners().end()}};
    return is_symmetric_ ? doubled(mesh) : mesh;
  }

  /// A half with its mirror image. Blocks that end in the middle become whole there: both halves have the
  /// same subdivision edge.
  static BaseMesh doubled(const BaseMesh& half) {
    BaseMesh whole = half;
    std::vector<std::uint16_t> mirror;
    for (std::size_t v = 0; v < half.uv.size(); ++v) {
      const bool in_middle = half.uv[v].x == 0.5f;
      mirror.push_back(static_cast<std::uint16_t>(in_middle ? v : whole.uv.size()));
      if (!in_middle) whole.uv.push_back({1 - half.uv[v].x, half.uv[v].y});
    }
    for (std::size_t f = 0; f < half.corners.size(); f += 3)
      for (const std::size_t k : {std::size_t{1}, std::size_t{0}, std::size_t{2}})
        whole.corners.push_back(mirror[half.corners[f + k]]);
    return whole;
  }

  const Source& source_;
  const bool is_symmetric_;
  const SkinBoundary boundary_;
  FieldGrid shape_;
  std::vector<Vec3> openings_;   // places on the edges of openings
  std::vector<int> candidates_;  // vertices of the source, in random order
  float edge_ = 10;              // wanted length away from openings, millimetres
  Domain domain_;
  std::vector<Vec3> positions_;  // of domain_.points
  std::vector<char> is_fixed_;
  Triangles triangles_;
};

}  // namespace

BaseMesh make_base_mesh(const Source& source, int vertices, bool is_symmetric) {
  return BaseMesher(source, is_symmetric).run(vertices);
}

}  // namespace pliant::host::bake
