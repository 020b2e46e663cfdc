#pragma once
/// \file source_check.hpp
/// What is wrong with a source: what a table cannot hold, and why the surface will probably not be tracked.
#include <string>
#include <vector>

#include "host/bake/source.hpp"

namespace pliant::host::bake {

/// Throws SourceError for what a table cannot hold, each by its name.
/// \param file  the source, for errors
void check_source(const Source& source, const std::string& file);

/// A line for the user for each reason.
/// \param surface  the vertices of the surface (reconstruction.hpp)
std::vector<std::string> tracking_warnings(const Source& source, const std::vector<std::size_t>& surface);

}  // namespace pliant::host::bake
