#pragma once
/// \file parameter_choice.hpp
/// Chooses some of a source's parameters, for a smaller table.
#include <string>
#include <vector>

#include "host/bake/source.hpp"

namespace pliant::host::bake {

struct ParameterChoice {
  int identities = -1;             ///< number of identities to keep, the first ones; all if negative
  int expressions = -1;            ///< number of expressions to keep, the most useful ones
                                   ///< (arkit_names.hpp), both of a pair or none; all if negative
  std::vector<std::string> named;  ///< if not empty, exactly these expressions
};

/// Drops all other parameters and their shapes; the order stays. Expressions without a name of ARKit's rank after all others,
/// by how far they move the vertices. Throws SourceError for a name that is no expression, and for an expression that is the
/// mirror image of one that is not chosen.
void choose_parameters(Source& source, const ParameterChoice& choice);

}  // namespace pliant::host::bake
