// Dijkstra's algorithm over a graph of edges and of diagonals of unfolded pairs of triangles.
#include "host/bake/surface_distance.hpp"

#include <algorithm>
#include <functional>
#include <queue>
#include <utility>

#include "host/bake/at.hpp"
#include "host/bake/edge.hpp"
#include "host/bake/places.hpp"

namespace pliant::host::bake {

namespace {

/// Distance of p and q, on either side of the edge from a to b, when both triangles are laid flat; 0 if the straight line between
/// them does not cross the edge.
float unfolded_distance(Vec3 a, Vec3 b, Vec3 p, Vec3 q) {
  const float edge = length(b - a);
  if (!(edge > 0)) return 0;
  const Vec3 along = (1 / edge) * (b - a);
  const float x = dot(p - a, along), u = dot(q - a, along);
  const float y = length(p - a - x * along), v = length(q - a - u * along);
  if (!(y + v > 0)) return 0;
  const float crossing = x + (u - x) * (y / (y + v));
  if (!(crossing >= 0 && crossing <= edge)) return 0;
  return square_root((u - x) * (u - x) + (y + v) * (y + v));
}

}  // namespace

SurfaceDistance::SurfaceDistance(const Source& source) : place_of_(places_of(source.neutral)) {
  std::vector<Vec3> position;
  for (std::size_t v = 0; v < place_of_.size(); ++v)
    if (at(place_of_[v]) == position.size()) position.push_back(source.neutral[v]);
  links_.resize(position.size());
  add_edges(source, position);
}

void SurfaceDistance::add_edges(const Source& source, const std::vector<Vec3>& position) {
  std::vector<std::pair<Edge, int>> sides;  // of each triangle: an edge, and the corner opposite
  for (std::size_t f = 0; f < source.triangles.size(); ++f) {
    if (source.is_hole[f]) continue;
    std::array<int, 3> t = source.triangles[f];
    for (int& v : t) v = place_of_[at(v)];
    for (std::size_t k = 0; k < 3; ++k) sides.push_back({edge_of(t[k], t[(k + 1) % 3]), t[(k + 2) % 3]});
  }
  std::sort(sides.begin(), sides.end());
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const auto [a, b] = sides[k].first;
    const Vec3 from = position[at(a)], to = position[at(b)];
    if (k == 0 || sides[k - 1].first != sides[k].first) {
      link(a, b, length(to - from));
      continue;
    }
    const int p = sides[k - 1].second, q = sides[k].second;
    const float across = unfolded_distance(from, to, position[at(p)], position[at(q)]);
    if (across > 0) link(p, q, across);
  }
}

void SurfaceDistance::link(int a, int b, float length) {
  links_[at(a)].push_back({b, length});
  links_[at(b)].push_back({a, length});
}

std::vector<float> SurfaceDistance::from(std::size_t vertex) const {
  std::vector<float> of_place(links_.size(), kNoPath);
  using Reached = std::pair<float, int>;  // distance, place
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> next;
  of_place[at(place_of_[vertex])] = 0;
  next.push({0.0f, place_of_[vertex]});
  while (!next.empty()) {
    const auto [distance, place] = next.top();
    next.pop();
    if (distance > of_place[at(place)]) continue;
    for (const Link& l : links_[at(place)]) {
      const float sum = distance + l.length;
      if (!(sum < of_place[at(l.to)])) continue;
      of_place[at(l.to)] = sum;
      next.push({sum, l.to});
    }
  }
  std::vector<float> result;
  for (const int place : place_of_) result.push_back(of_place[at(place)]);
  return result;
}

}  // namespace pliant::host::bake
