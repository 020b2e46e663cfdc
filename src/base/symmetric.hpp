#pragma once
// Symmetric 2 x 2 matrices: information and structure tensors.
#include "pliant/geometry.hpp"

namespace pliant {

/// v^T S v.
constexpr float quadratic_form(const Sym2& s, Vec2 v) {
  return s.xx * v.x * v.x + 2 * s.xy * v.x * v.y + s.yy * v.y * v.y;
}

/// Eigenvalues of a symmetric matrix.
struct Eigenvalues {
  float smallest, largest;
};
inline Eigenvalues eigenvalues(const Sym2& s) {
  const float half_sum = 0.5f * (s.xx + s.yy), half_difference = 0.5f * (s.xx - s.yy);
  const float root = square_root(half_difference * half_difference + s.xy * s.xy);
  return {half_sum - root, half_sum + root};
}

/// Unit eigenvector of the largest eigenvalue, x >= 0; zero where both are the same.
inline Vec2 strongest_direction(const Sym2& s, float smallest) {
  // Both rows of S - smallest I are parallel to it; the longer one has the smaller rounding error.
  const Vec2 u{s.xx - smallest, s.xy}, v{s.xy, s.yy - smallest};
  const Vec2 w = dot(u, u) >= dot(v, v) ? u : v;
  const float norm = length(w);
  return norm > 0 ? ((w.x < 0 ? -1.0f : 1.0f) / norm) * w : Vec2{};
}

}  // namespace pliant
