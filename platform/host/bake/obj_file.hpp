#pragma once
/// \file obj_file.hpp
/// Reads meshes from Wavefront OBJ files: positions, texture coordinates and polygons. Normals are
/// skipped, and groups but for one name.
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
  std::vector<ObjCorner> corners;      ///< the corners of all polygons, in order
  std::vector<int> polygon_end;        ///< for each polygon, the index after its last corner
  std::vector<int> polygon_line;       ///< for each polygon, its line in the file
  std::vector<std::string> libraries;  ///< material libraries, as the file names them
  std::vector<std::string> materials;  ///< names of the materials that polygons use; the first is empty
  std::vector<int> material;           ///< for each polygon, index in `materials`
  std::vector<char> is_fixed;          ///< for each polygon, whether it is in a group of the name "fixed"
};

/// Reads a file. Throws SourceError with the line for an incomplete line, an index out of range or a malformed number.
ObjMesh read_obj(const std::string& path);

/// Reads a mesh that has the polygons of `like`. Throws SourceError if the polygons differ.
ObjMesh read_obj_like(const std::string& path, const ObjMesh& like);

}  // namespace pliant::host::bake
