#pragma once
/// \file reconstruction.hpp
/// How faithful a model table is to its source: the table itself is opened and evaluated, quantisation and all.
#include <string>
#include <vector>

#include "host/bake/source.hpp"

namespace pliant::host::bake {

/// Distances between vertices of the skin and the table's points at their (u,v), in millimetres.
struct Distances {
  float mean_mm = 0, p95_mm = 0, max_mm = 0;
};

struct ParameterError {
  std::string name;
  Group group;
  Distances off;
};

/// The whole shape is measured: rest shape plus one parameter, an identity at one standard deviation, an expression at its
/// maximum. `identity` and `expression` are over all vertices of all such shapes. Mirror images, which share
/// the samples of the other side, are left out.
struct Reconstruction {
  Distances rest, identity, expression;
  std::vector<ParameterError> parameters;
};

/// \param model  the table that the baker made of this source, opened.
Reconstruction reconstruct(const Model& model, const Source& source);

}  // namespace pliant::host::bake
