#pragma once
/// \file robust.hpp
/// Robust losses of the length of a residual, and a robust scale of such lengths (docs/algorithms.md, section 5.6).
#include <cstddef>

#include "pliant/geometry.hpp"

namespace pliant {

/// Losses of a residual; `squares` is the one that is not robust.
enum class Loss { squares, huber, tukey };

/// Loss rho(u) and weight rho'(u) / u at u = residual length / scale. Precondition: u >= 0.
/// rho(u) = u^2 / 2 near 0 in all three. Huber's loss is linear beyond 1.345. Tukey's loss is constant, with weight 0,
/// beyond 4.685. With these constants both are 95 % efficient for normal residuals.
struct LossValue {
  float rho, weight;  ///< rho(u), and weight rho'(u) / u
};
LossValue evaluate(Loss loss, float u);  ///< Loss and weight at u.

/// Robust scale of n lengths of residuals in the plane: their median divided by the median of a Rayleigh
/// variable of unit scale. 0 for n = 0. Reorders `length`. Cost: as `select`.
float robust_scale(float* length, std::size_t n);

/// The k-th smallest of n values, counted from 0. Reorders the values. If one of them is NaN, the result is
/// any of them.
/// Precondition: k < n.
/// Cost: O(n) on average and O(n log n) at most: Hoare's quickselect, which changes to a heap after a fixed
/// number of rounds.
float select(float* value, std::size_t n, std::size_t k);

}  // namespace pliant
