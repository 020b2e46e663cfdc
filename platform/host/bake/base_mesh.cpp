// Three steps. First points are placed: along the boundary, at landmarks, then at vertices of the source that keep a distance
// from all points so far. Then they are triangulated in the chart. Then points and edges are improved in turn: each point
// moves towards the centroid of its triangles, and edges are flipped by the triangles' shape in space.
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

/// Tuning of the base mesh. Each constant: unit, reason, experiment. None was tuned by an experiment; the shapes of the
/// resulting triangles are tested (auto_base_mesh_test).
struct BaseMeshTuning {
  /// Samples on a side of the raster of the rest shape, count: a sample every millimetre of a face.
  int raster_side = 257;
  /// Vertices of one half, the middle line included, as a fraction of the whole.
  double half_fraction = 0.52;
  /// Range in which the edge length is searched for, millimetres, and halvings of it, count: to within 0.03 %.
  double least_edge_mm = 1, largest_edge_mm = 100;
  int bisections = 14;
  /// Rounds of moving points and flipping edges, count. Later rounds move points by less than a per cent of an edge.
  int relaxations = 40;
  /// Length of edges at openings as a fraction of the length elsewhere. Lips and lids need smaller triangles.
  float opening_fraction = 0.5f;
  /// Increase of the wanted length per millimetre away from an opening, no unit. Keeps neighbours alike in size.
  float growth = 0.35f;
  /// Least distance of a landmark, and of any other point, from its neighbours, in wanted lengths. 0.83 fills the plane with
  /// a mean distance of one.
  float landmark_spacing = 0.5f, point_spacing = 0.83f;
  /// Distance in the chart up to which a landmark lies on a boundary loop, and least distance between anchors there.
  float on_loop = 0.003f, anchor_spacing = 0.015f;
  /// Points on a loop without anchors, count, at least. Fewer do not enclose an area in basic blocks.
  int least_loop_points = 6;
  /// Twice the area in the chart below which a triangle counts as inverted. Above the rounding error of floats.
  float least_doubled_area = 1e-7f;
};
constexpr BaseMeshTuning kTuning{};

class BaseMesher {
 public:
  BaseMesher(const Source& source, bool is_symmetric)
      : source_(source), is_symmetric_(is_symmetric), boundary_(find_boundary(source, is_symmetric)) {
    const ChartRaster raster =
        rasterise(source.uv, source.triangles, source.is_hole, kTuning.raster_side, kTuning.raster_side);
    shape_ = grid_of(raster, source.neutral);
    for (const BoundaryLoop& loop : boundary_.loops)
      for (std::size_t k = 0; k < loop.vertices.size(); ++k)
        if (loop.sides[k] == Side::opening) openings_.push_back(source.neutral[at(loop.vertices[k])]);
    shuffle_candidates();
  }

  BaseMesh run(int vertices) {
    // Without symmetry the count is of the whole, with it of one half and the middle.
    const double wanted = is_symmetric_ ? kTuning.half_fraction * vertices : vertices;
    double low = kTuning.least_edge_mm, high = kTuning.largest_edge_mm;
    for (int round = 0; round < kTuning.bisections; ++round) {
      edge_ = static_cast<float>(std::sqrt(low * high));
      place_points();
      (static_cast<double>(domain_.points.size()) > wanted ? low : high) = static_cast<double>(edge_);
    }
    triangles_ = triangulate(domain_);
    if (triangles_.empty()) return {};
    for (int round = 0; round < kTuning.relaxations; ++round) relax();
    return paired();
  }

 private:
  Vec3 position(Vec2 uv) const {
    return {sample(shape_, 0, uv), sample(shape_, 1, uv), sample(shape_, 2, uv)};
  }

  /// Wanted length of edges at p, millimetres.
  float edge_at(Vec3 p) const {
    float nearest = 1e9f;
    for (Vec3 o : openings_) nearest = std::min(nearest, dot(p - o, p - o));
    return std::min(edge_, kTuning.opening_fraction * edge_ + kTuning.growth * std::sqrt(nearest));
  }

  void shuffle_candidates() {
    std::vector<char> usable(source_.uv.size(), 0);
    for (std::size_t f = 0; f < source_.triangles.size(); ++f)
      for (int v : source_.triangles[f]) usable[at(v)] |= boundary_.is_inside[f];
    for (const BoundaryLoop& loop : boundary_.loops)
      for (int v : loop.vertices) usable[at(v)] = 0;
    for (std::size_t v = 0; v < usable.size(); ++v)
      if (usable[v]) candidates_.push_back(static_cast<int>(v));
    std::uint32_t state = 12345;  // a fixed pseudo-random order
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
      if (is_inside(l.uv) && is_free_at(p, kTuning.landmark_spacing * edge_at(p))) add_point(l.uv, true);
    }
    for (int v : candidates_) {
      const Vec3 p = source_.neutral[at(v)];
      if (is_free_at(p, kTuning.point_spacing * edge_at(p))) add_point(source_.uv[at(v)], false);
    }
  }

  /// True within the outer loop and outside all others, by the parity of crossings.
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

  /// Vertices of the loop that must be kept: where the kind of its edges changes, and next to landmarks.
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
      const Vec2 here = source_.uv[at(loop.vertices[best])];
      bool is_near_another = false;
      for (std::size_t k = 0; k < n; ++k)
        is_near_another |=
            is_anchor[k] && length(source_.uv[at(loop.vertices[k])] - here) < kTuning.anchor_spacing;
      if (length(here - l.uv) < kTuning.on_loop && !is_near_another) is_anchor[best] = 1;
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

  /// Places points from one anchor up to, but not including, the next. Each step has the length wanted there.
  void place_run(const BoundaryLoop& loop, std::size_t start, std::size_t end, std::vector<int>& placed) {
    const std::size_t n = loop.vertices.size();
    const auto vertex = [&](std::size_t k) { return loop.vertices[k % n]; };
    std::vector<float> steps{0};  // along the run, in wanted lengths
    for (std::size_t k = start; k < end; ++k) {
      const Vec3 a = source_.neutral[at(vertex(k))], b = source_.neutral[at(vertex(k + 1))];
      steps.push_back(steps.back() + length(b - a) / edge_at(0.5f * (a + b)));
    }
    const bool whole_loop = end - start == n;
    const int pieces =
        std::max(whole_loop ? kTuning.least_loop_points : 1, static_cast<int>(std::lround(steps.back())));
    for (int piece = 0; piece < pieces; ++piece) {
      const float wanted = steps.back() * static_cast<float>(piece) / static_cast<float>(pieces);
      const std::size_t k =
          static_cast<std::size_t>(std::upper_bound(steps.begin(), steps.end() - 1, wanted) - steps.begin()) -
          1;
      const float fraction = (wanted - steps[k]) / std::max(1e-9f, steps[k + 1] - steps[k]);
      const Vec2 a = source_.uv[at(vertex(start + k))], b = source_.uv[at(vertex(start + k + 1))];
      placed.push_back(add_point(a + fraction * (b - a), true));
    }
  }

  /// Moves each free point to the centroid of its triangles, each weighted by its area on the surface over the wanted area,
  /// unless that inverts a triangle. Then flips edges.
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
      if (inverts_one(star[v])) domain_.points[v] = before;
      positions_[v] = position(domain_.points[v]);
    }
    flip_by_shape(triangles_, domain_.points, positions_);
  }

  bool inverts_one(const std::vector<std::size_t>& star) const {
    return std::any_of(star.begin(), star.end(), [&](std::size_t f) {
      const Vec2 a = domain_.points[at(triangles_[f][0])], b = domain_.points[at(triangles_[f][1])],
                 c = domain_.points[at(triangles_[f][2])];
      return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) <= kTuning.least_doubled_area;
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

  /// Joins a half to its mirror image. Basic blocks that end on the middle line are completed by the mirrored triangle, as
  /// both halves have the same subdivision edge there.
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
  const SurfaceBoundary boundary_;
  FieldGrid shape_;
  std::vector<Vec3> openings_;   // vertices around openings
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
