#pragma once
/// \file observation.hpp
/// The interface between geometry and pixels: predictions and observations of surface points.
#include <cstdint>

#include "pliant/geometry.hpp"

namespace pliant {

/// The expected image of a surface point.
struct Prediction {
  std::uint16_t id = 0;  ///< of the surface point; stable from frame to frame
  Vec2 x;                ///< px; far outside the image for a point behind the camera
  Sym2 covariance;       ///< of x, px^2, from the uncertainty of the predicted state
  Mat2 jacobian;         ///< dx/d(u,v), px per unit; a template is warped by J J_ref^-1
  Vec2 normal;  ///< unit normal of the expected edge in the image; zero for points that are not on an edge
  float facing = 0;  ///< cosine between the surface normal and the direction to the camera; <= 0 faces away
  bool visible = false;  ///< turned to the camera, inside the image, and not hidden by the surface
};

/// The measurement behind an observation.
enum class Cue : std::uint8_t {
  patch = 0,  ///< a template was found
  flow = 1,   ///< a patch of the previous frame was found
  edge = 2,   ///< an edge was found along its normal
};

/// Whether a surface point has an observation in a frame, and why not.
enum class Reason : std::uint8_t {
  found = 0,             ///< it has one
  not_visible = 1,       ///< turned away, hidden, or not a point that can be observed
  outside_image = 2,     ///< what is compared reaches beyond the image
  no_texture = 3,        ///< nothing that can be located
  diverged = 4,          ///< the search did not converge near its start
  low_correlation = 5,   ///< what was found is not like the template or the remembered edge
  forward_backward = 6,  ///< tracking back does not return to the start
  rejected = 7,          ///< an outlier, by the solve
  ambiguous = 8,         ///< more edges of similar contrast than alternatives may be given
};

/// A measured image position of a surface point. Consecutive observations with one id are alternatives, of
/// which at most one is true.
struct Observation {
  std::uint16_t id = 0;  ///< of its surface point
  Vec2 x;                ///< px; within a million px of the picture's corner, else not_visible
  Sym2 information;  ///< 1/px^2, semi-definite, at most 1e12, else not_visible; rank one: edges, normal flow
  Cue cue = Cue::patch;           ///< kind of measurement
  Reason reason = Reason::found;  ///< only `found` is used; others count as searched
  float score = 0;  ///< normalised correlation or contrast, in [-1,1]; not a number: not_visible
  Vec2 residual;    ///< after a solve: x minus the projection of the surface point, px
};

}  // namespace pliant
