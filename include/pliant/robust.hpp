#pragma once
/// \file robust.hpp
/// Robust losses of a residual's length and the scale they are measured in (ALGORITHMS: section 5.6).
#include <cstddef>

#include "pliant/geometry.hpp"

namespace pliant {

enum class Loss { squares, huber, tukey };

/// Loss rho(u) and its weight rho'(u)/u at u = residual length / scale >= 0. rho(u) = u^2/2 near 0 in all three.
/// Huber with 1.345; Tukey with 4.685, constant and of weight 0 beyond.
struct LossValue {
  float rho, weight;
};
LossValue evaluate(Loss loss, float u);

/// Scale of n residual lengths in the plane: their median divided by 1.1774 (that of a Rayleigh variable of unit scale).
/// Reorders `length`. 0 for n = 0. Cost: as `select`.
float robust_scale(float* length, std::size_t n);

/// The k-th smallest (from 0) of n values, k < n, none of them NaN (any of the values otherwise). Reorders them. Cost:
/// O(n) on average, bounded by O(n log n): Hoare's quickselect, after a bounded number of rounds a heap.
float select(float* value, std::size_t n, std::size_t k);

}  // namespace pliant
