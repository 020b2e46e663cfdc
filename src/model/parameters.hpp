// Ranges and groups of a model's parameters.
#pragma once
#include "pliant/model.hpp"

namespace pliant {

/// q, or the nearer end of the parameter's range.
inline float within_range(const Parameter& p, float q) {
  return clamp(q, p.minimum, p.maximum);
}

/// How many of a model's parameters are in a group.
std::size_t count_of(Group group, const Model& model);

}  // namespace pliant
