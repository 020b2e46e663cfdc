#pragma once
/// \file principal_components.hpp
/// Deformations learnt from data: the mean of registered shapes and the directions in which they vary most.
#include <vector>

#include "pliant/geometry.hpp"

namespace pliant::host::bake {

struct PrincipalComponents {
  std::vector<Vec3> mean;
  /// Each one standard deviation long: a shape is the mean plus the sum of q_k times component k, q_k of unit
  /// variance.
  std::vector<std::vector<Vec3>> components;
  std::vector<float> explained;  ///< share of the whole variance that each explains, falling
};

/// The first `count` components of at least two shapes of one size; `count` is less than their number. Every
/// vertex weighs the same. Cost: shapes^2 times vertices.
PrincipalComponents find_components(const std::vector<std::vector<Vec3>>& shapes, int count);

}  // namespace pliant::host::bake
