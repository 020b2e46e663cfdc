#pragma once
/// \file parameter_choice.hpp
/// A part of a source's parameters, for a smaller table.
#include <string>
#include <vector>

#include "host/bake/source.hpp"

namespace pliant::host::bake {

struct ParameterChoice {
  int identities = -1;             ///< so many, the first; negative: all
  int expressions = -1;            ///< so many, the most useful (arkit_names.hpp), pairs whole; negative: all
  std::vector<std::string> named;  ///< these expressions instead, when not empty
};

/// Drops the parameters not chosen, and their shapes. Order stays. Of expressions without ARKit's names, those that
/// move most come first. Throws SourceError for a name that is no expression, or one whose samples are the mirror image
/// of an expression that is not chosen.
void choose_parameters(Source& source, const ParameterChoice& choice);

}  // namespace pliant::host::bake
