// Catmull-Clark subdivision with sharp edges (Hoppe et al. 1994).
#include "host/bake/subdivision.hpp"

#include <algorithm>

#include "host/bake/at.hpp"
#include "host/bake/edge.hpp"

namespace pliant::host::bake {

namespace {

struct Level {
  std::vector<Stencil> stencils;
  std::vector<std::vector<int>> faces;
  std::vector<int> cage_face;
};

struct EdgeInfo {
  std::vector<std::size_t> faces;
  bool sharp = false;
  int point = -1;  ///< new vertex on it
};

/// A sum of weighted stencils in a dense row that is cleared after use.
class StencilSum {
 public:
  explicit StencilSum(std::size_t points) : sum_(points, 0.0f), touched_(points, 0) {}
  void add(const Stencil& s, float weight) {
    for (const auto& [point, w] : s) {
      if (!touched_[at(point)]) used_.push_back(point);
      touched_[at(point)] = 1;
      sum_[at(point)] += weight * w;
    }
  }
  Stencil take() {
    std::sort(used_.begin(), used_.end());
    Stencil result;
    result.reserve(used_.size());
    for (int p : used_) {
      result.push_back({p, sum_[at(p)]});
      sum_[at(p)] = 0;
      touched_[at(p)] = 0;
    }
    used_.clear();
    return result;
  }

 private:
  std::vector<float> sum_;
  std::vector<char> touched_;
  std::vector<int> used_;
};

std::map<Edge, EdgeInfo> edges_of(const Level& level, const Cage& cage) {
  std::map<Edge, EdgeInfo> edges;
  for (std::size_t f = 0; f < level.faces.size(); ++f) {
    const auto& c = level.faces[f];
    for (std::size_t k = 0; k < c.size(); ++k) edges[edge_of(c[k], c[(k + 1) % c.size()])].faces.push_back(f);
  }
  const auto is_hole = [&](std::size_t f) { return cage.faces[at(level.cage_face[f])].is_hole; };
  for (auto& [ends, e] : edges) e.sharp = e.faces.size() == 1 || is_hole(e.faces[0]) != is_hole(e.faces[1]);
  return edges;
}

/// One round of subdivision. Its vertices are the old ones, moved, then one for each edge, then one for each face.
class Round {
 public:
  Round(const Level& old, const Cage& cage) : old_(old), sum_(cage.size()), edges_(edges_of(old, cage)) {}

  Level run() {
    make_face_points();
    const std::size_t n = old_.stencils.size();
    next_.stencils.resize(n);
    make_edge_points();
    move_old_points();
    make_faces();
    return std::move(next_);
  }
  const std::map<Edge, EdgeInfo>& edges() const { return edges_; }

 private:
  void make_face_points() {
    for (const auto& c : old_.faces) {
      for (int v : c) sum_.add(old_.stencils[at(v)], 1.0f / static_cast<float>(c.size()));
      face_points_.push_back(sum_.take());
    }
  }

  void make_edge_points() {
    for (auto& [ends, e] : edges_) {
      const float weight = e.sharp ? 0.5f : 0.25f;
      sum_.add(old_.stencils[at(ends.first)], weight);
      sum_.add(old_.stencils[at(ends.second)], weight);
      if (!e.sharp)
        for (std::size_t f : e.faces) sum_.add(face_points_[f], 0.25f);
      e.point = static_cast<int>(next_.stencils.size());
      next_.stencils.push_back(sum_.take());
    }
  }

  void move_old_points() {
    const std::size_t n = old_.stencils.size();
    std::vector<std::vector<std::size_t>> faces(n);
    std::vector<std::vector<int>> neighbours(n), sharp(n);
    for (std::size_t f = 0; f < old_.faces.size(); ++f)
      for (int v : old_.faces[f]) faces[at(v)].push_back(f);
    for (const auto& [ends, e] : edges_)
      for (const auto& [v, other] : {ends, Edge{ends.second, ends.first}})
        (e.sharp ? sharp : neighbours)[at(v)].push_back(other);
    for (std::size_t v = 0; v < n; ++v) {
      if (sharp[v].size() == 2) {
        sum_.add(old_.stencils[v], 0.75f);
        for (int other : sharp[v]) sum_.add(old_.stencils[at(other)], 0.125f);
      } else {
        // (Q + 2 R + (n - 3) V) / n, with Q the mean of face points and R the mean of edge midpoints.
        const float count = static_cast<float>(faces[v].size());
        for (std::size_t f : faces[v]) sum_.add(face_points_[f], 1 / (count * count));
        for (const auto* list : {&neighbours[v], &sharp[v]})
          for (int other : *list) sum_.add(old_.stencils[at(other)], 1 / (count * count));
        sum_.add(old_.stencils[v], (count - 2) / count);
      }
      next_.stencils[v] = sum_.take();
    }
  }

  void make_faces() {
    for (std::size_t f = 0; f < old_.faces.size(); ++f) {
      const auto& c = old_.faces[f];
      const int centre = static_cast<int>(next_.stencils.size());
      next_.stencils.push_back(face_points_[f]);
      for (std::size_t k = 0; k < c.size(); ++k) {
        const int before = c[(k + c.size() - 1) % c.size()], after = c[(k + 1) % c.size()];
        next_.faces.push_back(
            {c[k], edges_.at(edge_of(c[k], after)).point, centre, edges_.at(edge_of(before, c[k])).point});
        next_.cage_face.push_back(old_.cage_face[f]);
      }
    }
  }

  const Level& old_;
  StencilSum sum_;
  std::map<Edge, EdgeInfo> edges_;
  std::vector<Stencil> face_points_;
  Level next_;
};

}  // namespace

SubdividedCage subdivide(const Cage& cage, int levels) {
  Level level;
  for (std::size_t i = 0; i < cage.size(); ++i) level.stencils.push_back({{static_cast<int>(i), 1.0f}});
  for (const CageFace& face : cage.faces) {
    level.faces.push_back(face.corners);
    level.cage_face.push_back(static_cast<int>(level.cage_face.size()));
  }
  SubdividedCage fine;
  for (const auto& [ends, e] : edges_of(level, cage)) fine.edges[ends] = {ends.first, ends.second};
  for (int l = 0; l < levels; ++l) {
    Round round(level, cage);
    Level next = round.run();
    for (auto& [ends, chain] : fine.edges) {
      std::vector<int> longer{chain[0]};
      for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
        longer.push_back(round.edges().at(edge_of(chain[i], chain[i + 1])).point);
        longer.push_back(chain[i + 1]);
      }
      chain = std::move(longer);
    }
    level = std::move(next);
  }
  fine.stencils = std::move(level.stencils);
  fine.cage_face = std::move(level.cage_face);
  for (const auto& f : level.faces) fine.quads.push_back({f[0], f[1], f[2], f[3]});
  return fine;
}

std::vector<int> path_through(const SubdividedCage& fine, const std::vector<int>& points) {
  std::vector<int> path;
  for (std::size_t k = 0; k < points.size(); ++k) {
    path.push_back(points[k]);
    if (k + 1 == points.size()) break;
    const int a = points[k], b = points[k + 1];
    const auto edge = fine.edges.find(edge_of(a, b));
    if (edge == fine.edges.end()) continue;
    std::vector<int> inner(edge->second.begin() + 1, edge->second.end() - 1);
    if (a > b) std::reverse(inner.begin(), inner.end());
    path.insert(path.end(), inner.begin(), inner.end());
  }
  return path;
}

template <class T>
std::vector<T> fine_values(const SubdividedCage& fine, const std::vector<T>& controls) {
  std::vector<T> values;
  values.reserve(fine.stencils.size());
  for (const Stencil& s : fine.stencils) {
    T value{};
    for (const auto& [point, weight] : s) value = value + weight * controls[at(point)];
    values.push_back(value);
  }
  return values;
}

template <class T>
std::vector<T> controls_through(const SubdividedCage& fine, const std::vector<T>& targets, int rounds,
                                const std::vector<char>& is_still) {
  std::vector<T> controls = targets;
  for (int round = 0; round < rounds; ++round) {
    std::vector<T> residual;
    for (std::size_t i = 0; i < targets.size(); ++i) {
      T value{};
      for (const auto& [point, weight] : fine.stencils[i]) value = value + weight * controls[at(point)];
      residual.push_back(targets[i] + -1.0f * value);
    }
    for (std::size_t i = 0; i < targets.size(); ++i)
      if (is_still.empty() || !is_still[i]) controls[i] = controls[i] + residual[i];
  }
  return controls;
}

template std::vector<float> fine_values(const SubdividedCage&, const std::vector<float>&);
template std::vector<Vec2> fine_values(const SubdividedCage&, const std::vector<Vec2>&);
template std::vector<Vec3> fine_values(const SubdividedCage&, const std::vector<Vec3>&);
template std::vector<float> controls_through(const SubdividedCage&, const std::vector<float>&, int,
                                             const std::vector<char>&);
template std::vector<Vec3> controls_through(const SubdividedCage&, const std::vector<Vec3>&, int,
                                            const std::vector<char>&);

}  // namespace pliant::host::bake
