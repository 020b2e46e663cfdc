#include "host/bake/chart_raster.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <numeric>

#include "host/bake/at.hpp"
#include "host/bake/edge.hpp"

namespace pliant::host::bake {

namespace {

/// Twice the area in the chart below which a triangle has no barycentric coordinates.
constexpr float kLeastArea = 1e-12f;

struct Corners {
  Vec2 a, b, c;
  float area() const { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }
};

Corners corners(const std::vector<Vec2>& uv, const std::array<int, 3>& t) {
  return {uv[at(t[0])], uv[at(t[1])], uv[at(t[2])]};
}

std::array<float, 3> barycentric(const Corners& t, Vec2 p) {
  const float area = t.area();
  const float wb = ((p.x - t.a.x) * (t.c.y - t.a.y) - (p.y - t.a.y) * (t.c.x - t.a.x)) / area;
  const float wc = ((t.b.x - t.a.x) * (p.y - t.a.y) - (t.b.y - t.a.y) * (p.x - t.a.x)) / area;
  return {1 - wb - wc, wb, wc};
}

/// Finds the nearest of some points in the chart; of several at one distance, the first.
class NearestPoint {
 public:
  explicit NearestPoint(const std::vector<Vec2>& points)
      : points_(points),
        side_(std::clamp(static_cast<int>(std::sqrt(static_cast<double>(points.size()))), 1, kMostCells)),
        cells_(at(side_ * side_)) {
    for (std::size_t k = 0; k < points.size(); ++k)
      cells_[at(cell(points[k].y) * side_ + cell(points[k].x))].push_back(k);
  }

  /// Precondition: there are points.
  std::size_t find(Vec2 p) const {
    std::size_t best = 0;
    float least = std::numeric_limits<float>::max();
    const int column = cell(p.x), row = cell(p.y);
    for (int ring = 0; ring < side_; ++ring) {
      // Points in this ring are at least so far away; the slack is above the rounding error.
      const float nearest = (static_cast<float>(ring - 1) - 1e-3f) / static_cast<float>(side_);
      if (ring > 0 && nearest > 0 && nearest * nearest > least) break;
      for (int j = std::max(row - ring, 0); j <= std::min(row + ring, side_ - 1); ++j)
        for (int i = std::max(column - ring, 0); i <= std::min(column + ring, side_ - 1); ++i) {
          if (std::max(std::abs(i - column), std::abs(j - row)) < ring) continue;
          for (const std::size_t k : cells_[at(j * side_ + i)]) {
            const Vec2 d = p - points_[k];
            const float distance = dot(d, d);
            if (distance < least || (distance <= least && k < best)) least = distance, best = k;
          }
        }
    }
    return best;
  }

 private:
  static constexpr int kMostCells = 256;  // on a side; bounds the memory
  int cell(float x) const {
    return std::clamp(static_cast<int>(x * static_cast<float>(side_)), 0, side_ - 1);
  }

  const std::vector<Vec2>& points_;
  const int side_;
  std::vector<std::vector<std::size_t>> cells_;
};

class Rasteriser {
 public:
  Rasteriser(const std::vector<Vec2>& uv, const std::vector<std::array<int, 3>>& triangles,
             ChartRaster& raster)
      : uv_(uv), triangles_(triangles), raster_(raster) {}

  /// Assigns triangle f to the samples inside it that have no triangle yet.
  void cover(std::size_t f) {
    const Corners t = corners(uv_, triangles_[f]);
    if (std::fabs(t.area()) < kLeastArea) return;
    const float w = static_cast<float>(raster_.width - 1), h = static_cast<float>(raster_.height - 1);
    const auto [left, right] = std::minmax({t.a.x, t.b.x, t.c.x});
    const auto [top, bottom] = std::minmax({t.a.y, t.b.y, t.c.y});
    constexpr float kSlack = 1e-4f;  // keeps samples on a shared edge despite rounding
    for (int j = static_cast<int>(std::ceil(top * h - kSlack)); j <= static_cast<int>(bottom * h + kSlack);
         ++j)
      for (int i = static_cast<int>(std::ceil(left * w - kSlack)); i <= static_cast<int>(right * w + kSlack);
           ++i) {
        ChartSample& s = raster_.samples[at(j * raster_.width + i)];
        if (s.triangle != kFree) continue;
        const auto weight = barycentric(t, {static_cast<float>(i) / w, static_cast<float>(j) / h});
        if (std::min({weight[0], weight[1], weight[2]}) < -kSlack) continue;
        s = {triangles_[f], weight, static_cast<std::int32_t>(f)};
      }
  }

  /// Extrapolates the surface beyond its boundary: a sample within one sample of it takes the linear extrapolation of the
  /// nearest boundary triangle of the part beside it. A bilinear cell that the boundary cuts is then as accurate as the others.
  void extrapolate_surface(const std::vector<char>& is_hole) {
    struct Border {
      std::vector<std::size_t> triangles;
      std::vector<Vec2> centroids;
      std::vector<std::pair<int, int>> beside;
    };
    const std::vector<int> part = parts(is_hole);
    const auto part_of = [&](std::size_t f) { return part[at(triangles_[f][0])]; };
    std::map<int, Border> borders;  // of the parts
    for (const std::size_t f : boundary_triangles(is_hole)) {
      const Corners t = corners(uv_, triangles_[f]);
      if (std::fabs(t.area()) < kLeastArea) continue;
      borders[part_of(f)].triangles.push_back(f);
      borders[part_of(f)].centroids.push_back((1.0f / 3) * (t.a + t.b + t.c));
    }
    for (int j = 0; j < raster_.height; ++j)
      for (int i = 0; i < raster_.width; ++i)
        if (raster_.at(i, j).triangle < 0)
          if (const std::int32_t f = covered_beside(i, j); f >= 0)
            borders[part_of(at(f))].beside.push_back({i, j});
    for (const auto& [_, border] : borders) {
      if (border.triangles.empty()) continue;
      const NearestPoint nearest(border.centroids);
      for (const auto& [i, j] : border.beside) {
        const Vec2 p = place(i, j);
        const std::size_t f = border.triangles[nearest.find(p)];
        raster_.samples[at(j * raster_.width + i)] = {triangles_[f],
                                                      barycentric(corners(uv_, triangles_[f]), p), kBeside};
      }
    }
  }

  /// Gives every sample without a triangle the value of the nearest sample that has one.
  void fill_remaining() {
    std::vector<std::pair<int, int>> front;
    std::vector<char> done(raster_.samples.size(), 0);
    for (int j = 0; j < raster_.height; ++j)
      for (int i = 0; i < raster_.width; ++i)
        if (raster_.at(i, j).triangle != kFree) {
          done[at(j * raster_.width + i)] = 1;
          front.push_back({i, j});
        }
    for (std::size_t next = 0; next < front.size(); ++next) {
      const auto [i, j] = front[next];
      constexpr int kStep[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
      for (const auto& step : kStep) {
        const int k = i + step[0], l = j + step[1];
        if (k < 0 || l < 0 || k >= raster_.width || l >= raster_.height || done[at(l * raster_.width + k)])
          continue;
        done[at(l * raster_.width + k)] = 1;
        ChartSample copy = raster_.at(i, j);
        copy.triangle = kBeside;
        raster_.samples[at(l * raster_.width + k)] = copy;
        front.push_back({k, l});
      }
    }
    for (ChartSample& s : raster_.samples) s.triangle = std::max(s.triangle, -1);
  }

  static constexpr std::int32_t kFree = -2;    // no triangle assigned yet
  static constexpr std::int32_t kBeside = -1;  // outside the surface

 private:
  Vec2 place(int i, int j) const {
    return {static_cast<float>(i) / static_cast<float>(raster_.width - 1),
            static_cast<float>(j) / static_cast<float>(raster_.height - 1)};
  }

  /// The triangle of a covered sample next to this one; -1 if there is none.
  std::int32_t covered_beside(int i, int j) const {
    for (int l = std::max(j - 1, 0); l <= std::min(j + 1, raster_.height - 1); ++l)
      for (int k = std::max(i - 1, 0); k <= std::min(i + 1, raster_.width - 1); ++k)
        if (raster_.at(k, l).triangle >= 0) return raster_.at(k, l).triangle;
    return -1;
  }

  /// The part of the surface, by its first vertex, of each vertex.
  std::vector<int> parts(const std::vector<char>& is_hole) const {
    std::vector<int> part(uv_.size());
    std::iota(part.begin(), part.end(), 0);
    const auto root = [&part](int v) {
      while (part[at(v)] != v) v = part[at(v)] = part[at(part[at(v)])];
      return v;
    };
    for (std::size_t f = 0; f < triangles_.size(); ++f)
      for (const int v : triangles_[f])
        if (!is_hole[f]) {
          const auto [first, second] = std::minmax({root(v), root(triangles_[f][0])});
          part[at(second)] = first;
        }
    for (std::size_t v = 0; v < part.size(); ++v) part[v] = root(static_cast<int>(v));
    return part;
  }

  /// Triangles of the surface with an edge on its boundary.
  std::vector<std::size_t> boundary_triangles(const std::vector<char>& is_hole) const {
    const std::vector<Edge> boundary = boundary_edges(triangles_, is_hole);
    std::vector<std::size_t> found;
    for (std::size_t f = 0; f < triangles_.size(); ++f) {
      const auto& t = triangles_[f];
      const auto lies_there = [&](int a, int b) {
        return std::binary_search(boundary.begin(), boundary.end(), edge_of(a, b));
      };
      if (!is_hole[f] && (lies_there(t[0], t[1]) || lies_there(t[1], t[2]) || lies_there(t[2], t[0])))
        found.push_back(f);
    }
    return found;
  }

  const std::vector<Vec2>& uv_;
  const std::vector<std::array<int, 3>>& triangles_;
  ChartRaster& raster_;
};

}  // namespace

ChartRaster rasterise(const std::vector<Vec2>& uv, const std::vector<std::array<int, 3>>& triangles,
                      const std::vector<char>& is_hole, int width, int height) {
  ChartRaster raster{width, height, {}};
  raster.samples.assign(at(width) * at(height), ChartSample{{0, 0, 0}, {1, 0, 0}, Rasteriser::kFree});
  Rasteriser work(uv, triangles, raster);
  for (std::size_t f = 0; f < triangles.size(); ++f)
    if (!is_hole[f]) work.cover(f);
  work.extrapolate_surface(is_hole);
  for (std::size_t f = 0; f < triangles.size(); ++f)
    if (is_hole[f]) work.cover(f);
  work.fill_remaining();
  return raster;
}

std::vector<float> chart_areas(const std::vector<Vec2>& uv,
                               const std::vector<std::array<int, 3>>& triangles) {
  std::vector<float> areas;
  for (const auto& t : triangles) areas.push_back(corners(uv, t).area());
  return areas;
}

}  // namespace pliant::host::bake
