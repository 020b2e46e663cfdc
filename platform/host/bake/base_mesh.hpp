#pragma once
/// \file base_mesh.hpp
/// Lays a base mesh of nearly equal triangles over the skin of a source (the paper, 5.1): along its outline
/// and its openings, through its landmarks, in basic blocks.
#include <cstdint>
#include <vector>

#include "host/bake/source.hpp"

namespace pliant::host::bake {

struct BaseMesh {
  std::vector<Vec2> uv;
  std::vector<std::uint16_t> corners;  ///< three a face
};

/// About `vertices` vertices (60 to 5,000). Triangles are of one size on the rest shape, but down to half as
/// long along openings. With `is_symmetric` the mesh is its own mirror image. Landmarks are vertices where
/// they are not closer to each other than half an edge. Empty when the skin's boundary crosses itself in the
/// chart.
BaseMesh make_base_mesh(const Source& source, int vertices, bool is_symmetric);

}  // namespace pliant::host::bake
