#pragma once
/// \file surface_boundary.hpp
/// Where the skin of a source ends: its outline and its openings.
#include <vector>

#include "host/bake/source.hpp"

namespace pliant::host::bake {

/// What lies across an edge of the boundary.
enum class Side { outside, opening, other_half };

struct BoundaryLoop {
  std::vector<int> vertices;  ///< of the source, in order
  std::vector<Side> sides;    ///< of the edge from each vertex to the next
};

struct SkinBoundary {
  std::vector<BoundaryLoop> loops;  ///< the outline first
  std::vector<char> is_inside;      ///< a triangle of the source
};

/// The boundary of the skin; of its half with u >= 0.5 when `half`. A loop beside the outline is an opening,
/// whether triangles close it or not.
SkinBoundary find_boundary(const Source& source, bool half);

}  // namespace pliant::host::bake
