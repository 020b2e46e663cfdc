#pragma once
/// \file base_mesh.hpp
/// Makes a base mesh in basic blocks over the surface of a source (the paper, section 5.1). Its edges lie along the boundary
/// and the openings, its vertices on landmarks, and its triangles are nearly equal.
#include <cstdint>
#include <vector>

#include "host/bake/source.hpp"

namespace pliant::host::bake {

struct BaseMesh {
  std::vector<Vec2> uv;
  std::vector<std::uint16_t> corners;  ///< three a face
};

/// Makes about `vertices` vertices (60 to 5,000). All edges have about one length on the rest shape; along openings down to
/// half of it. With `is_symmetric` the mesh is its own mirror image. A landmark becomes a vertex unless another one is
/// closer than half an edge. The mesh is empty if the surface's boundary intersects itself in the chart.
BaseMesh make_base_mesh(const Source& source, int vertices, bool is_symmetric);

}  // namespace pliant::host::bake
