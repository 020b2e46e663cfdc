#pragma once
/// \file observation.hpp
/// The one seam between geometry and pixels: surface points predicted into the image, and what was seen of them.
#include <cstdint>

#include "pliant/geometry.hpp"

namespace pliant {

/// Where the model expects a surface point in the next image, and how it will look.
struct Prediction {
  std::uint16_t id = 0;  ///< stable name of the surface point
  Vec2 x;                ///< px; far outside the image for a point behind the camera
  Sym2 covariance;       ///< of x (px^2), from the uncertainty of the predicted state
  Mat2 jacobian;         ///< dx/d(u,v), px per unit; a patch warps by J J_ref^-1
  Vec2 normal;           ///< unit, in the image, where an edge is expected; zero for points of the surface
  float facing = 0;  ///< cosine between the surface normal and the direction to the camera; <= 0 faces away
  bool visible = false;  ///< faces the camera, is inside the image and not hidden by the surface itself
};

/// What an observation comes from.
enum class Cue : std::uint8_t { patch = 0, flow = 1, edge = 2 };

/// Why a surface point has no observation in a frame.
enum class Reason : std::uint8_t {
  found = 0,
  not_visible = 1,
  outside_image = 2,
  no_texture = 3,
  diverged = 4,
  low_correlation = 5,
  forward_backward = 6,
  rejected = 7,
  ambiguous = 8,  ///< more edges alike than alternatives may be given
};

/// One thing seen of a surface point. Several with one id that stand next to each other are alternatives, of which one
/// is true.
struct Observation {
  std::uint16_t id = 0;
  Vec2 x;            ///< px
  Sym2 information;  ///< 1/px^2; of rank one for edges and normal flow
  Cue cue = Cue::patch;
  Reason reason = Reason::found;  ///< anything else: not used, kept for the counts
  float score = 0;                ///< normalised correlation or contrast, in [-1,1]
  Vec2 residual;                  ///< what the last solve has left: x less where the surface point is then
};

}  // namespace pliant
