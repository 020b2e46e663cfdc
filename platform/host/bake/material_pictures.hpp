#pragma once
/// \file material_pictures.hpp
/// The pictures of an OBJ mesh's materials.
#include <string>
#include <vector>

#include "host/bake/obj_file.hpp"
#include "host/io/image.hpp"

namespace pliant::host::bake {

/// Reads the pictures that the mesh's material files name, each once. Throws SourceError if one is missing or there are too many.
/// \param most_side   larger ones are reduced, pixels
/// \param picture_of  becomes the picture of each material, or -1
/// \param warnings    takes a line for each material file, and each material, that is missing
std::vector<Image> read_material_pictures(const ObjMesh& mesh, int most_side, std::vector<int>* picture_of,
                                          std::vector<std::string>* warnings);

}  // namespace pliant::host::bake
