#pragma once
/// \file face_source.hpp
/// The source of a face as a folder of readable tables (fixtures/face holds the built-in one and explains
/// each).
#include <string>

#include "host/bake/source.hpp"

namespace pliant::host::bake {

/// Reads all tables of `folder` and builds the surface. Throws SourceError.
Source read_face(const std::string& folder);

/// True where the folder holds such tables.
bool is_face_folder(const std::string& folder);

}  // namespace pliant::host::bake
