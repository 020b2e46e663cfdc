// Three steps: insertion of points by Bowyer and Watson, recovery of the boundary's edges by flips (Sloan 1993), removal of the
// triangles outside.
#include "host/bake/triangulation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <map>
#include <set>

#include "host/bake/at.hpp"
#include "host/bake/edge.hpp"
#include "host/io/polygon.hpp"

namespace pliant::host::bake {

namespace {

struct Point {
  double x, y;
};

double area(Point a, Point b, Point c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Positive where d lies within the circle through a, b, c (of positive area).
double in_circle(Point a, Point b, Point c, Point d) {
  const auto row = [d](Point p) {
    const double x = p.x - d.x, y = p.y - d.y;
    return std::array<double, 3>{x, y, x * x + y * y};
  };
  const auto p = row(a), q = row(b), r = row(c);
  return p[0] * (q[1] * r[2] - q[2] * r[1]) - p[1] * (q[0] * r[2] - q[2] * r[0]) +
         p[2] * (q[0] * r[1] - q[1] * r[0]);
}

/// The faces on both sides of each edge; -1 where there is none.
std::map<Edge, std::array<int, 2>> sides_of(const Triangles& triangles) {
  std::map<Edge, std::array<int, 2>> sides;
  for (std::size_t f = 0; f < triangles.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      auto [entry, fresh] =
          sides.insert({edge_of(triangles[f][k], triangles[f][(k + 1) % 3]), {static_cast<int>(f), -1}});
      if (!fresh) entry->second[1] = static_cast<int>(f);
    }
  return sides;
}

int opposite(const std::array<int, 3>& t, Edge e) {
  for (int v : t)
    if (v != e.first && v != e.second) return v;
  return -1;
}

/// Two triangles that share an edge, as a quad: edge a b, the other corners c (left of a -> b) and d.
struct Quad {
  int a, b, c, d;
};

Quad quad_of(const Triangles& triangles, Edge e, std::array<int, 2> faces) {
  const auto& t = triangles[at(faces[0])];
  const std::size_t k = static_cast<std::size_t>(std::find(t.begin(), t.end(), e.first) - t.begin());
  const bool forth = t[(k + 1) % 3] == e.second;
  const int a = forth ? e.first : e.second, b = forth ? e.second : e.first;
  return {a, b, opposite(t, e), opposite(triangles[at(faces[1])], e)};
}

/// Replaces edge a b by c d.
void flip(Triangles& triangles, std::array<int, 2> faces, const Quad& q) {
  triangles[at(faces[0])] = {q.a, q.d, q.c};
  triangles[at(faces[1])] = {q.b, q.c, q.d};
}

class Triangulator {
 public:
  explicit Triangulator(const Domain& domain) : domain_(domain) {
    for (Vec2 p : domain.points)
      points_.push_back(displaced({static_cast<double>(p.x), static_cast<double>(p.y)}));
    const int n = static_cast<int>(points_.size());
    for (const Point p : {Point{-20, -20}, Point{41, -20}, Point{-20, 41}}) points_.push_back(p);
    triangles_.push_back({n, n + 1, n + 2});
    for (int p = 0; p < n; ++p) insert(p);
  }

  Triangles run() {
    for (const auto& loop : domain_.loops)
      for (std::size_t k = 0; k < loop.size(); ++k) {
        const Edge e = edge_of(loop[k], loop[(k + 1) % loop.size()]);
        if (!recover(e)) return {};
        fixed_.insert(e);
      }
    remove_outside();
    return triangles_;
  }

 private:
  /// The point, displaced by up to kDisplacement in a fixed pseudo-random direction. Points of a regular grid lie on
  /// common lines and circles; the in-circle test has no consistent answer there, and the cavity of an inserted point is
  /// then no star. Displaced points are in general position.
  Point displaced(Point p) const {
    std::uint32_t h = 0x9e3779b9u * static_cast<std::uint32_t>(points_.size() + 1);
    const auto next = [&h] {
      h ^= h >> 15;
      h *= 0x2c1b3c6du;
      h ^= h >> 12;
      return kDisplacement * (static_cast<double>(h >> 8) / (1 << 23) - 1);
    };
    const double dx = next(), dy = next();
    return {p.x + dx, p.y + dy};
  }
  /// Chart units: less than the spacing of floats near 1, more than the rounding errors of the tests in double.
  static constexpr double kDisplacement = 1e-9;

  bool is_positive(const Quad& q) const {
    constexpr double kLeast = 1e-12;  // chart units squared
    return area(points_[at(q.a)], points_[at(q.d)], points_[at(q.c)]) > kLeast &&
           area(points_[at(q.b)], points_[at(q.c)], points_[at(q.d)]) > kLeast;
  }

  void insert(int p) {
    std::vector<std::array<int, 3>> kept;
    std::map<Edge, std::pair<int, std::array<int, 2>>>
        cavity;  // edges of removed triangles: count, direction
    for (const auto& t : triangles_) {
      if (in_circle(points_[at(t[0])], points_[at(t[1])], points_[at(t[2])], points_[at(p)]) <= 0) {
        kept.push_back(t);
        continue;
      }
      for (std::size_t k = 0; k < 3; ++k) {
        auto& use = cavity[edge_of(t[k], t[(k + 1) % 3])];
        ++use.first;
        use.second = {t[k], t[(k + 1) % 3]};
      }
    }
    for (const auto& [e, use] : cavity)
      if (use.first == 1) kept.push_back({use.second[0], use.second[1], p});
    triangles_ = std::move(kept);
  }

  bool crosses(Edge e, Edge f) const {
    if (e.first == f.first || e.first == f.second || e.second == f.first || e.second == f.second)
      return false;
    const Point a = points_[at(e.first)], b = points_[at(e.second)], c = points_[at(f.first)],
                d = points_[at(f.second)];
    return (area(a, b, c) > 0) != (area(a, b, d) > 0) && (area(c, d, a) > 0) != (area(c, d, b) > 0);
  }

  /// Flips edges that cross e until e is an edge: each in turn, and those that still cross it, or cannot be flipped yet, again
  /// after all others. False if e crosses an edge of the boundary.
  bool recover(Edge e) {
    if (sides_.empty()) sides_ = sides_of(triangles_);
    if (sides_.count(e)) return true;
    std::deque<Edge> crossing;
    for (const auto& [f, faces] : sides_)
      if (faces[1] >= 0 && crosses(e, f)) {
        if (fixed_.count(f)) return false;
        crossing.push_back(f);
      }
    const std::size_t most =
        100 + 20 * crossing.size() * crossing.size();  // bounds the time; far more than are needed
    for (std::size_t turn = 0; turn < most && !crossing.empty(); ++turn) {
      const Edge f = crossing.front();
      crossing.pop_front();
      const std::array<int, 2> faces = sides_.at(f);
      const Quad q = quad_of(triangles_, f, faces);
      if (!is_positive(q)) {
        crossing.push_back(f);
        continue;
      }
      flip_and_update(f, faces, q);
      if (crosses(e, edge_of(q.c, q.d))) crossing.push_back(edge_of(q.c, q.d));
    }
    return sides_.count(e) > 0;
  }

  /// Flips edge `old` and keeps sides_ what sides_of would find.
  void flip_and_update(Edge old, std::array<int, 2> faces, const Quad& q) {
    flip(triangles_, faces, q);
    const auto replace = [&](Edge e, int from, int to) {
      auto& s = sides_.at(e);
      for (int& f : s)
        if (f == from) f = to;
      if (s[1] >= 0 && s[0] > s[1]) std::swap(s[0], s[1]);
    };
    replace(edge_of(q.b, q.c), faces[0], faces[1]);
    replace(edge_of(q.a, q.d), faces[1], faces[0]);
    sides_.erase(old);
    sides_[edge_of(q.c, q.d)] = faces;
  }

  bool is_inside(Point p) const {
    bool inside = false;  // by the parity of crossings with all loops
    for (const auto& loop : domain_.loops)
      for (std::size_t k = 0; k < loop.size(); ++k)
        inside ^= crosses_edge(p, points_[at(loop[k])], points_[at(loop[(k + 1) % loop.size()])]);
    return inside;
  }

  void remove_outside() {
    const int n = static_cast<int>(domain_.points.size());
    const auto outside = [&](const std::array<int, 3>& t) {
      if (*std::max_element(t.begin(), t.end()) >= n) return true;
      const Point a = points_[at(t[0])], b = points_[at(t[1])], c = points_[at(t[2])];
      return !is_inside({(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3});
    };
    triangles_.erase(std::remove_if(triangles_.begin(), triangles_.end(), outside), triangles_.end());
  }

  const Domain& domain_;
  std::vector<Point> points_;
  Triangles triangles_;
  std::set<Edge> fixed_;
  std::map<Edge, std::array<int, 2>> sides_;
};

double cosine(Vec3 apex, Vec3 a, Vec3 b) {
  const Vec3 p = a - apex, q = b - apex;
  return static_cast<double>(dot(p, q)) / std::max(1e-9, static_cast<double>(length(p) * length(q)));
}

}  // namespace

Triangles triangulate(const Domain& domain) {
  return Triangulator(domain).run();
}

void flip_by_shape(Triangles& triangles, const std::vector<Vec2>& uv, const std::vector<Vec3>& position) {
  const auto plane = [&](int v) {
    return Point{static_cast<double>(uv[at(v)].x), static_cast<double>(uv[at(v)].y)};
  };
  const auto space = [&](int v) { return position[at(v)]; };
  constexpr int kPasses = 20;  // bounds the time; round value
  constexpr double kLeastFraction =
      0.1;  // of the pair's area in the chart, so that no triangle degenerates; round value
  constexpr double kStraight = 3.1416 + 1e-3;  // 180 degrees and a margin for rounding
  for (int round = 0; round < kPasses; ++round) {
    bool flipped = false;
    std::set<int> touched;
    for (const auto& [e, faces] : sides_of(triangles)) {
      if (faces[1] < 0 || touched.count(faces[0]) || touched.count(faces[1])) continue;
      const Quad q = quad_of(triangles, e, faces);
      // The other diagonal is better if the two angles opposite the edge add up to more than 180 degrees.
      const double angles = std::acos(std::clamp(cosine(space(q.c), space(q.a), space(q.b)), -1.0, 1.0)) +
                            std::acos(std::clamp(cosine(space(q.d), space(q.a), space(q.b)), -1.0, 1.0));
      if (angles < kStraight) continue;
      const double one = area(plane(q.a), plane(q.d), plane(q.c)),
                   other = area(plane(q.b), plane(q.c), plane(q.d));
      if (!(std::min(one, other) > kLeastFraction * (one + other))) continue;
      flip(triangles, faces, q);
      touched.insert(faces[0]);
      touched.insert(faces[1]);
      flipped = true;
    }
    if (!flipped) return;
  }
}

}  // namespace pliant::host::bake
