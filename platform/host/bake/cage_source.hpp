#pragma once
/// \file cage_source.hpp
/// Reads a source from a folder of readable tables: a control cage and its deformations. fixtures/face holds the tables of the
/// built-in face; each explains its columns.
#include <string>

#include "host/bake/source.hpp"

namespace pliant::host::bake {

/// Reads all tables of a folder and builds the surface. Throws SourceError.
Source read_cage_source(const std::string& folder);

/// True if the folder has a points.txt.
bool is_cage_folder(const std::string& folder);

}  // namespace pliant::host::bake
