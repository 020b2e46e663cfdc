#pragma once
/// \file surface_boundary.hpp
/// The boundary of a source's surface: one outer loop and its openings.
#include <vector>

#include "host/bake/source.hpp"

namespace pliant::host::bake {

/// The region on the other side of a boundary edge.
enum class Side { outside, opening, other_half };

struct BoundaryLoop {
  std::vector<int> vertices;  ///< of the source, in order
  std::vector<Side> sides;    ///< of the edge from each vertex to the next
};

struct SurfaceBoundary {
  std::vector<BoundaryLoop> loops;  ///< the outer loop first
  std::vector<char> is_inside;      ///< a triangle of the source
};

/// Finds the boundary of the surface; with `half`, of its half with u >= 0.5. The loop with the largest area in the chart is
/// the outer one. Every other loop is an opening, whether triangles of a hole fill it or not.
SurfaceBoundary find_boundary(const Source& source, bool half);

}  // namespace pliant::host::bake
