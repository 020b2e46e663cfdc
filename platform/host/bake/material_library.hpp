#pragma once
/// \file material_library.hpp
/// Material libraries of OBJ files (MTL): which picture a material has.
#include <map>
#include <string>
#include <vector>

namespace pliant::host::bake {

/// Reads the names of the pictures (`map_Kd`) of a material library by the names of its materials; a material without one has an
/// empty name. A name has the library's folder in front, and may have blanks in it. Bad input: the file cannot be read.
/// \param warnings  gets a line for each picture with options that would scale or move it: it is read without them.
std::map<std::string, std::string> read_picture_names(const std::string& path,
                                                      std::vector<std::string>* warnings);

}  // namespace pliant::host::bake
