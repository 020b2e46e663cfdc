#pragma once
/// \file reconstruction.hpp
/// Measures how far a model table is from its source, quantisation included.
#include <string>
#include <vector>

#include "host/bake/source.hpp"

namespace pliant::host::bake {

/// The vertices that the surface has, openings left out, in their order. Points on a cut of the chart appear twice.
std::vector<std::size_t> surface_vertices(const Source& source);

/// Distances between the vertices of the surface and the table's points at their (u,v), millimetres.
struct Distances {
  float mean_mm = 0, p95_mm = 0, max_mm = 0;
};

struct ParameterError {
  std::string name;
  Group group;
  Distances off;
};

/// Errors of whole shapes: the rest shape plus one parameter, an identity at one standard deviation or an expression at its
/// maximum. `identity` and `expression` are over all vertices of all such shapes. Mirror images have the samples, and so the
/// errors, of the other side; they are left out.
struct Reconstruction {
  Distances rest, identity, expression;
  std::vector<ParameterError> parameters;
};

/// \param model  the table that the baker made of this source, opened.
Reconstruction reconstruct(const Model& model, const Source& source);

}  // namespace pliant::host::bake
