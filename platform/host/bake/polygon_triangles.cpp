// The least narrow triangles are those with the least sum of costs, found by dynamic programming over runs of corners (Gilbert
// 1979, Klincsek 1980). Triangles of one winding that fill a polygon without crossings do not overlap.
#include "host/bake/polygon_triangles.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "host/bake/at.hpp"
#include "host/bake/chart_raster.hpp"

namespace pliant::host::bake {

namespace {

/// Tuning of the triangles. Each constant: unit, reason, experiment.
struct PolygonTuning {
  /// Height over longest side of each triangle from which on a fan is taken. With a straight line of corners it is 0, or of the
  /// size of the rounding error; half a square has 0.5, half a strip of 100:1 has 0.01. Round value, not tuned.
  double least_roundness = 1e-3;
  /// Height over longest side, at least, in a cost: bounds it. Above the rounding error of six digits.
  double rounding = 1e-5;
  /// Cost of a triangle of the other winding: above that of all narrow ones. Round value.
  double reversed = 1e9;
  /// Corners whose triangles are searched for, and that are tried as the apex of a fan, count, at most. Bounds the time.
  std::size_t most_corners = 64;
};
constexpr PolygonTuning kTuning;

using Triple = std::array<int, 3>;

class PolygonSplitter {
 public:
  PolygonSplitter(const std::vector<int>& corners, const std::vector<Vec2>& uv,
                  const std::vector<Vec3>& position)
      : corners_(corners), uv_(uv), position_(position) {
    for (std::size_t k = 2; k < corners.size(); ++k) area_ += chart_area(0, k - 1, k);
  }

  std::vector<Triple> run() const {
    const std::vector<Triple> first = fan(0);
    if (corners_.size() == 3 || is_good_fan()) return first;
    return corners_.size() <= kTuning.most_corners ? least_narrow() : widest_fan();
  }

 private:
  Triple triangle(std::size_t i, std::size_t j, std::size_t k) const {
    return {corners_[i], corners_[j], corners_[k]};
  }

  std::vector<Triple> fan(std::size_t apex) const {
    std::vector<Triple> result;
    const std::size_t n = corners_.size();
    for (std::size_t k = 2; k < n; ++k) result.push_back(triangle(apex, (apex + k - 1) % n, (apex + k) % n));
    return result;
  }

  /// Twice the signed area of a triangle of these corners in the chart.
  double chart_area(std::size_t i, std::size_t j, std::size_t k) const {
    const auto at_corner = [&](std::size_t c) {
      const Vec2 p = uv_[at(corners_[c])];
      return std::pair(static_cast<double>(p.x), static_cast<double>(p.y));
    };
    const auto [ax, ay] = at_corner(i);
    const auto [bx, by] = at_corner(j);
    const auto [cx, cy] = at_corner(k);
    return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
  }

  /// Height over longest side: in the chart, negative if the winding is not the polygon's, or in space where that is less.
  double roundness(std::size_t i, std::size_t j, std::size_t k) const {
    const Triple t = triangle(i, j, k);
    double chart_side = 0, side = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec2 a = uv_[at(t[(c + 1) % 3])] - uv_[at(t[c])];
      const Vec3 b = position_[at(t[(c + 1) % 3])] - position_[at(t[c])];
      chart_side = std::max(chart_side, static_cast<double>(dot(a, a)));
      side = std::max(side, static_cast<double>(dot(b, b)));
    }
    if (!(chart_side > 0 && side > 0)) return 0;
    const double in_chart = (area_ < 0 ? -1 : 1) * chart_area(i, j, k) / chart_side;
    const Vec3 a = position_[at(t[0])], normal = cross(position_[at(t[1])] - a, position_[at(t[2])] - a);
    return std::min(in_chart, static_cast<double>(length(normal)) / side);
  }

  bool is_good_fan() const {
    for (std::size_t k = 2; k < corners_.size(); ++k)
      if (!(roundness(0, k - 1, k) >= kTuning.least_roundness)) return false;
    return true;
  }

  double cost(std::size_t i, std::size_t j, std::size_t k) const {
    const double r = roundness(i, j, k);
    return 1 / std::max(r, kTuning.rounding) + (r < 0 ? kTuning.reversed : 0);
  }

  std::vector<Triple> least_narrow() const {
    const std::size_t n = corners_.size();
    // Of the corners from i to k: the least cost, and the third corner of the triangle at the line between them.
    std::vector<double> least(n * n, 0);
    std::vector<std::size_t> third(n * n, 0);
    for (std::size_t span = 2; span < n; ++span)
      for (std::size_t i = 0, k = span; k < n; ++i, ++k) {
        double best = std::numeric_limits<double>::infinity();
        for (std::size_t j = i + 1; j < k; ++j) {
          const double sum = least[i * n + j] + least[j * n + k] + cost(i, j, k);
          if (sum < best) best = sum, third[i * n + k] = j;
        }
        least[i * n + k] = best;
      }
    std::vector<Triple> result;
    std::vector<std::pair<std::size_t, std::size_t>> runs{{0, n - 1}};
    while (!runs.empty()) {
      const auto [i, k] = runs.back();
      runs.pop_back();
      if (k - i < 2) continue;
      const std::size_t j = third[i * n + k];
      result.push_back(triangle(i, j, k));
      runs.push_back({j, k});
      runs.push_back({i, j});
    }
    return result;
  }

  std::vector<Triple> widest_fan() const {
    std::vector<Triple> best;
    float best_area = 0;
    for (std::size_t apex = 0; apex < kTuning.most_corners; ++apex) {
      std::vector<Triple> tried = fan(apex);
      const auto areas = chart_areas(uv_, tried);
      const auto [least, most] = std::minmax_element(areas.begin(), areas.end());
      const float area = std::max(*least, -*most);  // positive if all triangles have one orientation
      if (apex > 0 && area <= best_area) continue;
      best = std::move(tried);
      best_area = area;
    }
    return best;
  }

  const std::vector<int>& corners_;
  const std::vector<Vec2>& uv_;
  const std::vector<Vec3>& position_;
  double area_ = 0;  // twice the signed area in the chart
};

}  // namespace

std::vector<std::array<int, 3>> triangles_of(const std::vector<int>& corners, const std::vector<Vec2>& uv,
                                             const std::vector<Vec3>& position) {
  return PolygonSplitter(corners, uv, position).run();
}

}  // namespace pliant::host::bake
