#pragma once
// Whether a patch has enough texture to be matched, and in how many directions.
#include "pliant/geometry.hpp"

namespace pliant::patch {

/// Texture of a patch, in the units of patch_arrays.hpp.
struct Texture {
  int pixels;          ///< usable ones
  float variance_sum;  ///< of grey levels, over the pixels
  Sym2 tensor;         ///< structure tensor of the gradients without light, summed over the pixels
};

/// True if a direction was set.
inline bool is_edge(Vec2 along) {
  return along.x != 0 || along.y != 0;
}

/// Whether a patch can be matched: enough usable pixels, and texture in both directions.
/// \param accepts_edges  texture in one direction is enough.
/// \param along  set to the unit direction of the texture if there is only one; zero otherwise.
bool is_usable(const Texture& texture, int window, bool accepts_edges, Vec2& along);

/// Adds to a tensor as much texture along the edge as there is across it, so that a solution of the system does not
/// move along the edge. \param amount  texture to add.
inline void confine(Sym2& tensor, Vec2 along, float amount) {
  tensor.xx += amount * along.y * along.y;
  tensor.xy -= amount * along.x * along.y;
  tensor.yy += amount * along.x * along.x;
}

}  // namespace pliant::patch
