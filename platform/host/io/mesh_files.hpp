#pragma once
/// \file mesh_files.hpp
/// Writes a triangle mesh in formats of other programs. Model axes, millimetres.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "pliant/geometry.hpp"

namespace pliant::host {

/// A triangle mesh with consecutive ids.
struct MeshData {
  std::vector<Vec3> position, normal;               ///< one a vertex
  std::vector<Vec2> uv;                             ///< one a vertex; v = 0 at the top
  std::vector<std::array<std::uint16_t, 3>> faces;  ///< counter-clockwise seen from outside
  std::vector<int> level;                           ///< for each face, bisections of the base mesh
};

/// Wavefront OBJ with v, vt, vn and f; the origin of vt is the lower left corner.
std::string obj_text(const MeshData& mesh);
/// PLY, binary little endian: x y z nx ny nz s t, and faces of three. Origin of s, t as in OBJ.
std::string ply_bytes(const MeshData& mesh);
/// glTF 2.0 in one binary file: one primitive with normals, u,v and indices; a node scales it to metres.
/// \param picture  the texture as PNG or JPEG, v = 0 in its first row; may be empty.
/// \param is_lit   false for a photograph, which contains the light.
std::string glb_bytes(const MeshData& mesh, const std::string& picture, bool is_lit = true);
/// An SVG picture of the chart; each face has the colour of its level.
std::string chart_svg(const MeshData& mesh);

}  // namespace pliant::host
