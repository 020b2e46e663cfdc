#pragma once
/// \file arkit_names.hpp
/// ARKit's names of expressions, and which of them a small model should have.
#include <string>
#include <vector>

#include "host/bake/source.hpp"

namespace pliant::host::bake {

/// Place of a name in the order in which a small model should have them, from 0: what a camera sees most of in speech
/// and everyday expression first. Where ARKit has one name for a pair, either side counts. The number of names for one
/// that is none of ARKit's.
std::size_t usefulness_rank(const std::string& name);

/// The expressions of a source that bear none of ARKit's names (nor one side of a pair that ARKit has one
/// name for).
std::vector<std::string> names_unknown_to_arkit(const Source& source);

}  // namespace pliant::host::bake
