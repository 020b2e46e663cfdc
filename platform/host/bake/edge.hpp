#pragma once
// Edges of a mesh, whichever way they are passed.
#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace pliant::host::bake {

/// Its ends, the smaller index first.
using Edge = std::pair<int, int>;
inline Edge edge_of(int a, int b) {
  return {std::min(a, b), std::max(a, b)};
}

/// The edges that belong to one triangle only, ascending. Sorted, not counted in a map: meshes of 100,000 triangles are usual.
/// \param is_left_out  triangles that do not count; empty: none
inline std::vector<Edge> boundary_edges(const std::vector<std::array<int, 3>>& triangles,
                                        const std::vector<char>& is_left_out = {}) {
  std::vector<Edge> all, once;
  for (std::size_t f = 0; f < triangles.size(); ++f)
    for (std::size_t k = 0; k < 3 && (is_left_out.empty() || !is_left_out[f]); ++k)
      all.push_back(edge_of(triangles[f][k], triangles[f][(k + 1) % 3]));
  std::sort(all.begin(), all.end());
  for (auto e = all.begin(); e != all.end();) {
    const auto end = std::find_if(e, all.end(), [&](const Edge& other) { return other != *e; });
    if (end - e == 1) once.push_back(*e);
    e = end;
  }
  return once;
}

}  // namespace pliant::host::bake
