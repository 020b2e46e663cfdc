#pragma once
/// \file shape_expansion.hpp
/// A model's shape at chosen points as a polynomial of the second degree in its parameters, for programs without the cascade.
#include <vector>

#include "pliant/model.hpp"

namespace pliant::host {

/// One term: every point moves by q_a times its vector, or by q_a q_b times it.
struct ShapeTerm {
  std::uint16_t a, b;      ///< parameters; b is kNone in a term of the first degree
  std::vector<Vec3> move;  ///< a point; mm per unit of q
};

/// p(q) = start + the sum of (c(q) - c(q at the start)) times each term's vector, with c(q) = q_a or q_a q_b.
struct ShapeExpansion {
  std::vector<Vec3> start;  ///< mm, a point
  std::vector<ShapeTerm> terms;
};

/// Expands the cascade about the neutral shape: exact for deformations that are added and for products of two parameters; of a
/// rotation, the first two degrees. Terms are fitted at one or two standard deviations, so that they hold where parameters
/// usually are. At the start the sum is exact. Terms that move no point by 1/2000 of the model's size are left out.
/// Cost: points x parameters x (1 + parameters that do not just add) evaluations.
/// \param q  all parameters, at the start.
ShapeExpansion expand_shape(const Model& model, const std::vector<Vec2>& uv, const std::vector<float>& q);

}  // namespace pliant::host
