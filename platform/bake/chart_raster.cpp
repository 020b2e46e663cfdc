#include "bake/chart_raster.hpp"

#include <algorithm>
#include <cmath>

namespace pliant::bake {

namespace {

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

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

class Rasteriser {
 public:
  Rasteriser(const std::vector<Vec2>& uv, const std::vector<std::array<int, 3>>& triangles,
             ChartRaster& raster)
      : uv_(uv), triangles_(triangles), raster_(raster) {}

  /// Claims the samples inside triangle f that nobody has claimed yet.
  void cover(std::size_t f) {
    const Corners t = corners(uv_, triangles_[f]);
    if (std::fabs(t.area()) < 1e-12f) return;
    const float w = static_cast<float>(raster_.width - 1), h = static_cast<float>(raster_.height - 1);
    const auto [left, right] = std::minmax({t.a.x, t.b.x, t.c.x});
    const auto [top, bottom] = std::minmax({t.a.y, t.b.y, t.c.y});
    constexpr float kSlack = 1e-4f;  // so that samples on a shared edge are not lost to rounding
    for (int j = static_cast<int>(std::ceil(top * h - kSlack)); j <= static_cast<int>(bottom * h + kSlack);
         ++j)
      for (int i = static_cast<int>(std::ceil(left * w - kSlack)); i <= static_cast<int>(right * w + kSlack);
           ++i) {
        ChartSample& s = raster_.samples[at(j * raster_.width + i)];
        if (s.triangle >= 0) continue;
        const auto weight = barycentric(t, {static_cast<float>(i) / w, static_cast<float>(j) / h});
        if (std::min({weight[0], weight[1], weight[2]}) < -kSlack) continue;
        s = {triangles_[f], weight, static_cast<std::int32_t>(f)};
      }
  }

  /// Gives every sample outside the mesh the triangle of the nearest sample inside, continued linearly for a
  /// short way and held after that.
  void extend() {
    struct Seed {
      int i, j;
    };
    std::vector<Seed> from(raster_.samples.size(), Seed{-1, -1});
    std::vector<Seed> front;
    for (int j = 0; j < raster_.height; ++j)
      for (int i = 0; i < raster_.width; ++i)
        if (raster_.at(i, j).triangle >= 0) {
          from[at(j * raster_.width + i)] = {i, j};
          front.push_back({i, j});
        }
    for (std::size_t next = 0; next < front.size(); ++next) {
      const Seed s = front[next];
      constexpr int kStep[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
      for (const auto& step : kStep) {
        const int i = s.i + step[0], j = s.j + step[1];
        if (i < 0 || j < 0 || i >= raster_.width || j >= raster_.height) continue;
        Seed& origin = from[at(j * raster_.width + i)];
        if (origin.i >= 0) continue;
        origin = from[at(s.j * raster_.width + s.i)];
        front.push_back({i, j});
        continue_to(i, j, origin.i, origin.j);
      }
    }
  }

 private:
  void continue_to(int i, int j, int from_i, int from_j) {
    const ChartSample source = raster_.at(from_i, from_j);
    constexpr float kReach = 3;  // samples
    const float di = static_cast<float>(i - from_i), dj = static_cast<float>(j - from_j);
    const float distance = std::sqrt(di * di + dj * dj), share = std::min(1.0f, kReach / distance);
    const Vec2 p{(static_cast<float>(from_i) + share * di) / static_cast<float>(raster_.width - 1),
                 (static_cast<float>(from_j) + share * dj) / static_cast<float>(raster_.height - 1)};
    const auto weight = barycentric(corners(uv_, source.vertex), p);
    raster_.samples[at(j * raster_.width + i)] = {source.vertex, weight, -1};
  }

  const std::vector<Vec2>& uv_;
  const std::vector<std::array<int, 3>>& triangles_;
  ChartRaster& raster_;
};

}  // namespace

ChartRaster rasterise(const std::vector<Vec2>& uv, const std::vector<std::array<int, 3>>& triangles,
                      const std::vector<char>& is_hole, int width, int height) {
  ChartRaster raster{width, height, {}};
  raster.samples.assign(at(width) * at(height), ChartSample{{0, 0, 0}, {1, 0, 0}, -1});
  Rasteriser work(uv, triangles, raster);
  for (const int hole : {0, 1})
    for (std::size_t f = 0; f < triangles.size(); ++f)
      if (is_hole[f] == hole) work.cover(f);
  work.extend();
  return raster;
}

std::vector<float> chart_areas(const std::vector<Vec2>& uv,
                               const std::vector<std::array<int, 3>>& triangles) {
  std::vector<float> areas;
  for (const auto& t : triangles) areas.push_back(corners(uv, t).area());
  return areas;
}

}  // namespace pliant::bake
