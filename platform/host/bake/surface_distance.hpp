#pragma once
/// \file surface_distance.hpp
/// Distances along a surface.
#include "host/bake/source.hpp"

namespace pliant::host::bake {

/// Paths over a surface: along the edges of its triangles, and across an edge from the one corner that it does not have to the
/// other, the two triangles laid flat. They are longer than the shortest way, on a lattice of squares by at most 8 %.
class SurfaceDistance {
 public:
  /// Distance of what no path joins, millimetres.
  static constexpr float kNoPath = 1e30f;

  /// Vertices at one place are joined. Triangles that fill an opening are left out.
  explicit SurfaceDistance(const Source& source);

  /// The length of the shortest path from a vertex to each one, millimetres, or kNoPath.
  std::vector<float> from(std::size_t vertex) const;

 private:
  struct Link {
    int to;  // place
    float length;
  };
  void add_edges(const Source& source, const std::vector<Vec3>& position);
  void link(int a, int b, float length);

  std::vector<int> place_of_;             // of each vertex
  std::vector<std::vector<Link>> links_;  // of each place
};

}  // namespace pliant::host::bake
