#pragma once
/// \file springs.hpp
/// Springs over a surface that bends and does not stretch: the section `stretch` of a model table.
#include "host/bake/source.hpp"

namespace pliant::host::bake {

/// Spreads points evenly over the surface and joins each to its neighbours, but not through the air: neither separate parts nor
/// the two sides of a fold or of an opening.
/// \param sd  standard deviation of a spring's length, as a fraction of it.
/// \return nothing if the surface has fewer than three vertices, or if no two points are neighbours.
SourceSprings make_springs(const Source& source, float sd);

}  // namespace pliant::host::bake
