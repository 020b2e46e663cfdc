#pragma once
// Normal flow: matches of patches that have texture in one direction only.
#include "vision/patch_refine.hpp"

namespace pliant {

/// The calls of a search. It makes them through PatchOptions::normal_flow only, so that a program which does not name it does not
/// link what is behind it.
struct NormalFlow {
  /// The rank of a match's information: 2, 1 for an edge, 0 where the gradients are noise.
  /// \param along        direction to which an edge has confined the search, unit; or zero.
  /// \param noise        variance of the picture's noise, grey levels squared.
  /// \param information  in: m.information; out: for rank 2 without the template's noise; for rank 1 that of the result, 1/px^2.
  int (*measure)(const patch::Measurement& m, Vec2 along, float noise, Sym2* information);
};

}  // namespace pliant
