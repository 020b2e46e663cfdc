// Three steps. First points are placed: along the boundary, at landmarks, then at vertices of the source that keep a distance
// from all points so far. Then they are triangulated in the chart. Then points and edges are improved in turn: each point
// moves towards the centroid of its triangles, and edges are flipped by the triangles' shape in space.
#include "host/bake/base_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "host/bake/at.hpp"
#include "host/bake/chart_raster.hpp"
#include "host/bake/field_grid.hpp"
#include "host/bake/loop_points.hpp"
#include "host/bake/surface_boundary.hpp"
#include "host/bake/triangulation.hpp"
#include "host/io/owned.hpp"
#include "host/io/polygon.hpp"
#include "pliant/base_mesh.hpp"

namespace pliant::host::bake {

namespace {

/// Tuning of the base mesh. Each constant: unit, reason, experiment. None was tuned by an experiment; the shapes of the
/// resulting triangles are tested (auto_base_mesh_test).
struct BaseMeshTuning {
  /// Samples on a side of the raster of the rest shape, count: a sample every millimetre of a face.
  int raster_side = 257;
  /// Vertices of one half, the middle line included, as a fraction of the whole: the line belongs to both halves.
  double half_fraction = 0.52;
  /// Least edge length of the search for a surface as large as a face, millimetres, the largest over the least, and halvings of the
  /// range, count: to within 0.03 %.
  double least_edge_mm = 1, edge_range = 100;
  int bisections = 14;
  /// Points at which a trial stops, as a multiple of the wanted ones, and points of a base mesh, count, at most. Round
  /// values.
  double trial_fraction = 3;
  /// Points after the last trial, as a multiple of the wanted ones, above which the coarser edge before it is taken. Round value.
  double most_excess = 1.06;
  std::size_t most_points = 9000;
  /// Vertices of the source that may become points, count, at most. Bounds the time; more do not change the shape.
  std::size_t most_candidates = 100000;
  /// Candidates for each wanted vertex, count, at least. Round value.
  int candidates_each = 8;
  /// Rounds of moving points and flipping edges, count. Later rounds move points by less than a per cent of an edge.
  int relaxations = 40;
  /// Length of edges at openings as a fraction of the length elsewhere. Lips and lids need smaller triangles. Round value.
  float opening_fraction = 0.5f;
  /// Increase of the wanted length per millimetre away from an opening, no unit. Keeps neighbours alike in size.
  float growth = 0.35f;
  /// Least distance of a landmark, and of any other point, from its neighbours, in wanted lengths. 0.83 fills the plane with
  /// a mean distance of one.
  float landmark_spacing = 0.5f, point_spacing = 0.83f;
  /// Cosine of the angle under which a point sees an edge of the boundary that it lies on: 170 degrees.
  float flat_cosine = -0.985f;
  /// Twice the area in the chart below which a triangle counts as inverted. Above the rounding error of floats.
  float least_doubled_area = 1e-7f;
};
constexpr BaseMeshTuning kTuning{};

/// Vertices minus edges plus triangles.
int euler_number(const std::vector<std::array<int, 3>>& triangles) {
  std::vector<int> vertices;
  std::vector<std::pair<int, int>> edges;
  for (const auto& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      vertices.push_back(t[k]);
      edges.push_back(std::minmax(t[k], t[(k + 1) % 3]));
    }
  std::sort(vertices.begin(), vertices.end());
  std::sort(edges.begin(), edges.end());
  const auto count = [](auto& all) { return std::unique(all.begin(), all.end()) - all.begin(); };
  return static_cast<int>(count(vertices) - count(edges)) + static_cast<int>(triangles.size());
}

class BaseMesher {
 public:
  BaseMesher(const Source& source, bool is_symmetric)
      : source_(source),
        is_symmetric_(is_symmetric),
        boundary_(find_boundary(source, is_symmetric)),
        loop_points_(source, boundary_) {
    const ChartRaster raster =
        rasterise(source.uv, source.triangles, source.is_hole, kTuning.raster_side, kTuning.raster_side);
    shape_ = grid_of(raster, source.neutral);
    for (const BoundaryLoop& loop : boundary_.loops)
      for (std::size_t k = 0; k < loop.vertices.size(); ++k)
        if (loop.sides[k] == Side::opening) openings_.push_back(source.neutral[at(loop.vertices[k])]);
    for (std::size_t f = 0; f < source.triangles.size(); ++f)
      if (boundary_.is_inside[f]) area_ += area_of(source.triangles[f]);
    area_ = std::max(area_, 1e-9);
  }

  BaseMesh run(int vertices) {
    make_candidates(vertices);
    // Without symmetry the count is of the whole, with it of one half and the middle.
    const double wanted = is_symmetric_ ? kTuning.half_fraction * vertices : vertices;
    const auto most = static_cast<std::size_t>(kTuning.trial_fraction * wanted);
    double low = kTuning.least_edge_mm * decade(wanted), high = kTuning.edge_range * low;
    for (int round = 0; round < kTuning.bisections; ++round) {
      edge_ = static_cast<float>(std::sqrt(low * high));
      const bool is_coarse = place_points(most) && static_cast<double>(domain_.points.size()) <= wanted;
      (is_coarse ? high : low) = static_cast<double>(edge_);
    }
    // On a regular source the count jumps, and the last edge may be on the other side of the jump.
    if (static_cast<double>(domain_.points.size()) > kTuning.most_excess * wanted)
      edge_ = static_cast<float>(high);
    // An intricate boundary takes more points than were asked for.
    if (!place_points(kTuning.most_points)) return {};
    triangles_ = triangulate(domain_);
    if (!drop_unused()) return {};
    for (int round = 0; round < kTuning.relaxations; ++round) relax();
    return paired();
  }

 private:
  Vec3 position(Vec2 uv) const {
    return {sample(shape_, 0, uv), sample(shape_, 1, uv), sample(shape_, 2, uv)};
  }

  double area_of(const std::array<int, 3>& t) const {
    const Vec3 a = source_.neutral[at(t[0])], b = source_.neutral[at(t[1])], c = source_.neutral[at(t[2])];
    return 0.5 * static_cast<double>(length(cross(b - a, c - a)));
  }

  /// Power of ten for which the range of edge lengths holds the one that `vertices` equilateral triangles would give, with
  /// a margin. 1 for a face.
  double decade(double vertices) const {
    const double edge = std::sqrt(area_ / vertices);
    double scale = 1;
    while (edge > 0.3 * kTuning.edge_range * kTuning.least_edge_mm * scale) scale *= 10;
    while (edge < 3 * kTuning.least_edge_mm * scale) scale /= 10;
    return scale;
  }

  /// Wanted length of edges at p, millimetres.
  float edge_at(Vec3 p) const {
    float nearest = std::numeric_limits<float>::max();
    for (Vec3 o : openings_) nearest = std::min(nearest, dot(p - o, p - o));
    return std::min(edge_, kTuning.opening_fraction * edge_ + kTuning.growth * std::sqrt(nearest));
  }

  /// Takes the vertices of the source inside the surface and, if these are few, random places in its triangles.
  void make_candidates(int vertices) {
    std::vector<char> usable(source_.uv.size(), 0);
    for (std::size_t f = 0; f < source_.triangles.size(); ++f)
      for (int v : source_.triangles[f]) usable[at(v)] |= boundary_.is_inside[f];
    for (const BoundaryLoop& loop : boundary_.loops)
      for (int v : loop.vertices) usable[at(v)] = 0;
    for (std::size_t v = 0; v < usable.size(); ++v)
      if (usable[v]) candidates_.push_back({source_.uv[v], source_.neutral[v]});
    std::uint32_t state = 12345;  // a fixed pseudo-random order
    const auto next = [&state] { return (state = state * 1664525u + 1013904223u) >> 8; };
    for (std::size_t k = candidates_.size(); k > 1; --k)
      std::swap(candidates_[k - 1], candidates_[next() % k]);
    candidates_.resize(std::min(candidates_.size(), kTuning.most_candidates));
    const std::size_t enough = at(kTuning.candidates_each * vertices);
    for (std::size_t f = 0; candidates_.size() < enough && f < source_.triangles.size(); ++f) {
      if (!boundary_.is_inside[f]) continue;
      const auto& t = source_.triangles[f];
      const double fraction = area_of(t) / area_;
      for (auto k = static_cast<std::size_t>(std::ceil(fraction * static_cast<double>(enough))); k > 0; --k) {
        float a = static_cast<float>(next()) * 0x1p-24f, b = static_cast<float>(next()) * 0x1p-24f;
        if (a + b > 1) a = 1 - a, b = 1 - b;
        const auto blend = [&](const auto& of) {
          return (1 - a - b) * of[at(t[0])] + a * of[at(t[1])] + b * of[at(t[2])];
        };
        candidates_.push_back({blend(source_.uv), blend(source_.neutral)});
      }
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

  /// Places points for `edge_`. False, with some of the points only, if there are more than `most`.
  bool place_points(std::size_t most) {
    domain_ = {};
    positions_.clear();
    is_fixed_.clear();
    loops_ = loop_points_.place([this](Vec3 p) { return edge_at(p); }, most);
    if (loops_.empty()) return false;
    for (const std::vector<Vec2>& loop : loops_) {
      std::vector<int> placed;
      for (const Vec2 uv : loop) placed.push_back(add_point(uv, true));
      domain_.loops.push_back(std::move(placed));
    }
    for (const SourceLandmark& l : source_.landmarks) {
      if (is_symmetric_ && l.uv.x < 0.5f) continue;
      const Vec3 p = position(l.uv);
      if (is_free_at(p, kTuning.landmark_spacing * edge_at(p)) && is_usable(l.uv)) add_point(l.uv, true);
    }
    for (const Candidate& c : candidates_) {
      if (!is_free_at(c.p, kTuning.point_spacing * edge_at(c.p)) || !is_usable(c.uv)) continue;
      add_point(c.uv, false);
      if (domain_.points.size() > most) return false;
    }
    return true;
  }

  /// True if triangles between p and the points along the boundary can have an area: p lies inside, and not on an edge there.
  bool is_usable(Vec2 p) const {
    bool inside = false;
    for (const std::vector<Vec2>& loop : loops_) {
      inside ^= is_inside(loop, p);
      for (std::size_t k = 0; k < loop.size(); ++k) {
        const Vec2 a = loop[k] - p, b = loop[(k + 1) % loop.size()] - p;
        if (dot(a, b) < kTuning.flat_cosine * length(a) * length(b)) return false;
      }
    }
    return inside;
  }

  /// Drops the points that no triangle uses. False if there are no triangles or a point of the boundary is unused.
  bool drop_unused() {
    std::vector<int> now(domain_.points.size(), -1);
    for (const auto& t : triangles_)
      for (const int v : t) now[at(v)] = 0;
    int count = 0;
    for (std::size_t v = 0; v < now.size(); ++v) {
      if (now[v] < 0) continue;
      now[v] = count;
      domain_.points[at(count)] = domain_.points[v];
      positions_[at(count)] = positions_[v];
      is_fixed_[at(count++)] = is_fixed_[v];
    }
    domain_.points.resize(at(count));
    positions_.resize(at(count));
    is_fixed_.resize(at(count));
    for (auto& t : triangles_)
      for (int& v : t) v = now[at(v)];
    for (auto& loop : domain_.loops)
      for (int& v : loop)
        if ((v = now[at(v)]) < 0) return false;
    return !triangles_.empty();
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
      const auto& t = triangles_[f];
      return doubled_area(domain_.points[at(t[0])], domain_.points[at(t[1])], domain_.points[at(t[2])]) <=
             kTuning.least_doubled_area;
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
    if (!covers_surface(mesh)) return {};
    return is_symmetric_ ? doubled(mesh) : mesh;
  }

  /// True if no triangle is inverted or without area, and the topology is that of the surface. The pairing has checked that each
  /// edge has one or two triangles and each vertex one fan.
  bool covers_surface(const BaseMesh& mesh) const {
    std::vector<std::array<int, 3>> triangles;
    for (std::size_t f = 0; f < mesh.corners.size(); f += 3)
      triangles.push_back({mesh.corners[f], mesh.corners[f + 1], mesh.corners[f + 2]});
    for (const float area : chart_areas(mesh.uv, triangles))
      if (!(area < 0)) return false;
    std::vector<std::array<int, 3>> inside;
    for (std::size_t f = 0; f < source_.triangles.size(); ++f)
      if (boundary_.is_inside[f]) inside.push_back(source_.triangles[f]);
    return euler_number(triangles) == euler_number(inside);
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
  const LoopPoints loop_points_;
  FieldGrid shape_;
  std::vector<Vec3> openings_;  // vertices around openings
  double area_ = 0;             // of the surface, square millimetres
  struct Candidate {
    Vec2 uv;
    Vec3 p;
  };
  std::vector<Candidate> candidates_;     // in random order
  float edge_ = 10;                       // wanted length away from openings, millimetres
  std::vector<std::vector<Vec2>> loops_;  // points along the boundary
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
