#pragma once
/// \file springs.hpp
/// Springs over a surface that bends and does not stretch: the section `stretch` of a model table.
#include "host/bake/source.hpp"

namespace pliant::host::bake {

/// Spreads points evenly over the surface and joins each to its neighbours.
/// \param sd  standard deviation of a spring's length, as a fraction of it.
/// \return no springs if the surface has fewer than three vertices.
SourceSprings make_springs(const Source& source, float sd);

}  // namespace pliant::host::bake
