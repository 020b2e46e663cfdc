#include "host/bake/springs.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/bake/reconstruction.hpp"
#include "host/bake/surface_distance.hpp"

namespace pliant::host::bake {

namespace {

/// Tuning of the springs. Each constant: unit, reason, experiment.
struct SpringTuning {
  /// Points, count, at most: a fifth of a sheet's width apart. 36 and 64 points are not more accurate and cost more; with an
  /// occluder of strong texture they made 26 of 300 frames wrong, 24 points 9 (docs/experiments.md, Sheet).
  std::size_t points = 24;
  /// Springs of a point, count, at most: its neighbours in a triangular lattice.
  std::size_t neighbours = 6;
  /// Longest spring over the largest distance of a point from its nearest one. Diagonals of a square lattice are within. Not tuned.
  float reach = 1.5f;
  /// Longest way along the surface over the straight distance of two points that are joined, no unit. The ways that are measured
  /// are up to 8 % too long; half a turn of a tube has 1.57, a right angle 1.41. With 1.15, 1.25 and 1.5 a book of two leaves at
  /// 50 degrees is tracked alike (0.20, 0.20, 0.19 degrees of rotation error; any way: 1.09), and 1.15 takes a fifth of the
  /// springs from a bottle.
  float detour = 1.25f;
};
constexpr SpringTuning kTuning{};

/// Farthest-point sampling: each next point is the vertex that is farthest from those before; the second of two at one place never
/// is.
std::vector<std::size_t> spread(const Source& source) {
  const std::vector<std::size_t> from = surface_vertices(source);
  std::vector<std::size_t> chosen;
  std::vector<float> distance(from.size(), 1e30f);
  std::size_t next = 0;
  while (chosen.size() < kTuning.points && chosen.size() < from.size()) {
    if (!chosen.empty()) {
      next = static_cast<std::size_t>(std::max_element(distance.begin(), distance.end()) - distance.begin());
      if (!(distance[next] > 0)) break;
    }
    chosen.push_back(from[next]);
    for (std::size_t k = 0; k < from.size(); ++k)
      distance[k] = std::min(distance[k], length(source.neutral[from[k]] - source.neutral[chosen.back()]));
  }
  return chosen;
}

/// Of each point the others to which the surface leads without a detour, the nearest first: a straight distance, and an index.
std::vector<std::vector<std::pair<float, std::size_t>>> neighbours(const Source& source,
                                                                   const std::vector<std::size_t>& chosen) {
  const SurfaceDistance along(source);
  std::vector<std::vector<std::pair<float, std::size_t>>> near(chosen.size());
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const std::vector<float> way = along.from(chosen[i]);
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      const float straight = length(source.neutral[chosen[i]] - source.neutral[chosen[k]]);
      if (k != i && way[chosen[k]] <= kTuning.detour * straight) near[i].push_back({straight, k});
    }
    std::sort(near[i].begin(), near[i].end());
  }
  return near;
}

}  // namespace

SourceSprings make_springs(const Source& source, float sd) {
  const std::vector<std::size_t> chosen = spread(source);
  SourceSprings result;
  if (chosen.size() < 3) return result;
  for (const std::size_t v : chosen) result.points.push_back(source.uv[v]);
  const auto near = neighbours(source, chosen);
  float gap = 0;
  for (const auto& others : near)
    if (!others.empty()) gap = std::max(gap, others.front().first);
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < chosen.size(); ++i)
    for (std::size_t n = 0; n < std::min(near[i].size(), kTuning.neighbours); ++n)
      if (near[i][n].first <= kTuning.reach * gap) pairs.push_back(std::minmax(i, near[i][n].second));
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  for (const auto& [i, k] : pairs) {
    const float rest = length(source.neutral[chosen[i]] - source.neutral[chosen[k]]);
    result.springs.push_back({static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(k), rest, sd * rest});
  }
  return result.springs.empty() ? SourceSprings{} : result;
}

}  // namespace pliant::host::bake
