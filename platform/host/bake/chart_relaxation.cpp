// Each vertex in turn takes one step down the gradient of the stretch of its triangles. The stretch of a triangle goes to
// infinity as its area in the chart goes to zero. A step that lowers it therefore inverts no triangle.
#include "host/bake/chart_relaxation.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <limits>

#include "host/bake/at.hpp"
#include "host/bake/edge.hpp"

namespace pliant::host::bake {

namespace {

using ChartPoint = Eigen::Vector2d;

class Relaxation {
 public:
  Relaxation(const std::vector<Vec2>& uv, const std::vector<Vec3>& position,
             const std::vector<std::array<int, 3>>& triangles)
      : triangles_(triangles), around_(uv.size()), is_fixed_(uv.size(), 0) {
    for (const Vec2 p : uv) chart_.emplace_back(static_cast<double>(p.x), static_cast<double>(p.y));
    for (const Vec3 p : position)
      surface_.emplace_back(static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z));
    for (std::size_t f = 0; f < triangles.size(); ++f)
      for (const int v : triangles[f]) around_[at(v)].push_back(f);
    for (const auto& [a, b] : boundary_edges(triangles)) is_fixed_[at(a)] = is_fixed_[at(b)] = 1;
  }

  void fill_square() {
    ChartPoint low = chart_[0], high = chart_[0];
    for (const ChartPoint& p : chart_) low = low.cwiseMin(p), high = high.cwiseMax(p);
    constexpr double kMargin = 1.0 / 64;
    for (ChartPoint& p : chart_)
      p = ChartPoint::Constant(kMargin) + (1 - 2 * kMargin) * (p - low).cwiseQuotient(high - low);
  }

  void sweep() {
    for (std::size_t v = 0; v < chart_.size(); ++v)
      if (!is_fixed_[v] && !around_[v].empty()) move(v);
  }

  const std::vector<ChartPoint>& chart() const { return chart_; }

 private:
  /// Integral over one triangle of the squared stretch; infinite for an inverted triangle.
  double stretch(std::size_t f) const {
    const auto& t = triangles_[f];
    const ChartPoint &a = chart_[at(t[0])], &b = chart_[at(t[1])], &c = chart_[at(t[2])];
    const double area = (c.x() - a.x()) * (b.y() - a.y()) - (b.x() - a.x()) * (c.y() - a.y());  // twice
    if (!(area > 1e-14)) return std::numeric_limits<double>::infinity();
    const Eigen::Vector3d &p = surface_[at(t[0])], &q = surface_[at(t[1])], &r = surface_[at(t[2])];
    const Eigen::Vector3d along_u = p * (b.y() - c.y()) + q * (c.y() - a.y()) + r * (a.y() - b.y()),
                          along_v = p * (c.x() - b.x()) + q * (a.x() - c.x()) + r * (b.x() - a.x());
    const double surface_area = 0.5 * (q - p).cross(r - p).norm();
    return 0.5 * (along_u.squaredNorm() + along_v.squaredNorm()) / (area * area) * surface_area;
  }

  double stretch_around(std::size_t v) const {
    double sum = 0;
    for (const std::size_t f : around_[v]) sum += stretch(f);
    return sum;
  }

  /// One step down the gradient, at most half as long as the shortest edge, halved until it lowers the stretch.
  void move(std::size_t v) {
    const ChartPoint start = chart_[v];
    double reach = 1;
    for (const std::size_t f : around_[v])
      for (const int w : triangles_[f])
        if (at(w) != v) reach = std::min(reach, (chart_[at(w)] - start).norm());
    const double before = stretch_around(v), h = 1e-3 * reach;
    ChartPoint gradient;
    for (int k = 0; k < 2; ++k) {
      chart_[v] = start + h * ChartPoint::Unit(k);
      const double ahead = stretch_around(v);
      chart_[v] = start - h * ChartPoint::Unit(k);
      gradient[k] = ahead - stretch_around(v);
    }
    chart_[v] = start;
    if (!gradient.allFinite() || gradient.norm() == 0) return;
    const ChartPoint direction = -gradient.normalized();
    for (double step = 0.5 * reach; step > 0.005 * reach; step *= 0.5) {
      chart_[v] = start + step * direction;
      if (stretch_around(v) < before) return;
    }
    chart_[v] = start;
  }

  const std::vector<std::array<int, 3>>& triangles_;
  std::vector<ChartPoint> chart_;
  std::vector<Eigen::Vector3d> surface_;
  std::vector<std::vector<std::size_t>> around_;  // triangles of each vertex
  std::vector<char> is_fixed_;
};

}  // namespace

void relax_chart(std::vector<Vec2>& uv, const std::vector<Vec3>& position,
                 const std::vector<std::array<int, 3>>& triangles, int sweeps) {
  Relaxation work(uv, position, triangles);
  work.fill_square();
  for (int k = 0; k < sweeps; ++k) work.sweep();
  for (std::size_t v = 0; v < uv.size(); ++v)
    uv[v] = {static_cast<float>(work.chart()[v].x()), static_cast<float>(work.chart()[v].y())};
}

}  // namespace pliant::host::bake
