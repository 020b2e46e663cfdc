#pragma once
/// \file surface_modes.hpp
/// The bending modes of a source's rest shape.
#include <string>

#include "host/bake/bending_modes.hpp"
#include "host/bake/source.hpp"

namespace pliant::host::bake {

/// Modes and corrections with one displacement for each vertex of the source. Vertices at one place move alike, so that cuts of
/// the chart do not open.
/// \param is_fixed  one a vertex: its place does not move.
/// \param file      of the rest shape, for errors
/// Throws SourceError if the surface has fewer modes than `count`, or more places than kMostModeVertices.
BendingModes surface_modes(const Source& source, const std::vector<char>& is_fixed, int count,
                           float stiffness, const std::string& file);

}  // namespace pliant::host::bake
