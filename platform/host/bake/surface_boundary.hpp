#pragma once
/// \file surface_boundary.hpp
/// The boundary of a source's surface: outer loops and openings.
#include <vector>

#include "host/bake/source.hpp"

namespace pliant::host::bake {

/// The region on the other side of a boundary edge.
enum class Side { outside, opening, other_half };

struct BoundaryLoop {
  std::vector<int> vertices;  ///< of the source, in order
  std::vector<Side> sides;    ///< of the edge from each vertex to the next
  bool is_hole = false;       ///< the surface lies around it, not within it
};

struct SurfaceBoundary {
  std::vector<BoundaryLoop> loops;  ///< the largest in the chart first
  std::vector<char> is_inside;      ///< a triangle of the source
};

/// Finds the boundary of the surface; with `half`, of its half with u >= 0.5. The loop with the largest area in the chart is
/// an outer one. Loops of the other direction are openings, whether triangles of a hole fill them or not.
SurfaceBoundary find_boundary(const Source& source, bool half);

}  // namespace pliant::host::bake
