#pragma once
/// \file principal_components.hpp
/// Principal components of registered shapes.
#include <vector>

#include "pliant/geometry.hpp"

namespace pliant::host::bake {

struct PrincipalComponents {
  std::vector<Vec3> mean;
  /// Each component is one standard deviation long: a shape is the mean plus the sum of q_k times component k, with q_k of
  /// unit variance.
  std::vector<std::vector<Vec3>> components;
  std::vector<float> explained;  ///< fraction of the variance that each explains, in descending order
};

/// Computes the first `count` components of at least two shapes with the same vertices; `count` is less than the number of
/// shapes. All vertices have the same weight. Cost: shapes^2 times vertices.
PrincipalComponents find_components(const std::vector<std::vector<Vec3>>& shapes, int count);

}  // namespace pliant::host::bake
