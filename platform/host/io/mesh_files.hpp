#pragma once
/// \file mesh_files.hpp
/// A triangle mesh as the bytes of files that other programs open. Model axes, millimetres.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "pliant/geometry.hpp"

namespace pliant::host {

/// Vertices and faces without gaps.
struct MeshData {
  std::vector<Vec3> position, normal;               ///< a vertex
  std::vector<Vec2> uv;                             ///< a vertex; v = 0 at the top
  std::vector<std::array<std::uint16_t, 3>> faces;  ///< counter-clockwise seen from outside
  std::vector<int> level;                           ///< a face: bisections of the base mesh
};

/// Wavefront OBJ: v, vt, vn, f; vt has its origin at the lower left, as OBJ wants it.
std::string obj_text(const MeshData& mesh);
/// PLY, binary little endian: x y z nx ny nz s t, and faces of three. Origin of s, t as in OBJ.
std::string ply_bytes(const MeshData& mesh);
/// glTF 2.0 in one binary file: one primitive with normals, u,v and indices. glTF has metres: a node scales.
/// \param picture  PNG or JPEG that u,v refer to, v = 0 in its first row; empty for a plain surface.
/// \param is_lit   false for a photograph, which has its light in it already.
std::string glb_bytes(const MeshData& mesh, const std::string& picture, bool is_lit = true);
/// The chart as a picture of lines, faces tinted by their level.
std::string chart_svg(const MeshData& mesh);

}  // namespace pliant::host
