#pragma once
/// \file arkit_names.hpp
/// ARKit's blendshape names, ordered by how useful they are in a small model.
#include <string>
#include <vector>

#include "host/bake/source.hpp"

namespace pliant::host::bake {

/// Rank of an expression's name, 0 the most useful: names that matter in speech and everyday expression come first.
/// Where ARKit has one name for a pair, the names of both sides have its rank. A name that ARKit does not have gets the
/// number of ARKit's names. The order is a judgement; it was not measured.
std::size_t usefulness_rank(const std::string& name);

/// The names of a face's expressions that ARKit does not have, neither alone nor as one side of a pair; and the sides of a pair
/// beside its single name (`browInnerUpLeft` beside `browInnerUp`), which is then the one that is taken for ARKit's. Empty if the
/// source is no face: it has neither a landmark of iBUG's nor any expression that ARKit has.
std::vector<std::string> names_unknown_to_arkit(const Source& source);

}  // namespace pliant::host::bake
