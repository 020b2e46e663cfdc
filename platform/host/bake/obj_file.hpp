#pragma once
/// \file obj_file.hpp
/// Meshes in Wavefront OBJ files: positions, texture coordinates and polygons; groups, normals and materials
/// are skipped.
#include <string>
#include <vector>

#include "pliant/geometry.hpp"

namespace pliant::host::bake {

struct ObjCorner {
  int vertex, texture;  ///< from 0; texture is -1 where the file gives none
};

struct ObjMesh {
  std::string path;
  std::vector<Vec3> vertices;
  std::vector<Vec2> texture;
  std::vector<ObjCorner> corners;  ///< of all polygons, one behind the other
  std::vector<int> polygon_end;    ///< a polygon: behind its last corner
  std::vector<int> polygon_line;   ///< a polygon: its line in the file
};

/// Reads a file. A cut line, an index out of range or a number that is none throws SourceError with its line.
ObjMesh read_obj(const std::string& path);

/// Only the positions, for a mesh that shares its polygons with one read before; throws SourceError when
/// their number, or that of the polygons and their corners, is not the same as in `like`.
std::vector<Vec3> read_obj_positions(const std::string& path, const ObjMesh& like);

}  // namespace pliant::host::bake
