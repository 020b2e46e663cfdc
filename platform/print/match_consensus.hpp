#pragma once
// Views of a surface that many matches agree on (docs/algorithms.md, section 7.17).
#include <cstddef>

#include "pliant/arena.hpp"
#include "pliant/camera.hpp"

namespace pliant {

/// A match, in terms of the surface: where it is on the surface, where it is seen, and which similarity of
/// the picture it suggests.
struct SurfaceMatch {
  Vec2 uv;
  Vec3 p;       ///< mm, at rest
  Vec2 x;       ///< ideal px
  Quat q;       ///< rotation of the view that it suggests
  float s = 1;  ///< scale of that view, px/mm
  float sd_px = 1;
};

/// A view, the match that suggests it, and the number of matches that it explains.
struct ViewVotes {
  View view;
  int votes = 0;
  std::size_t match = 0;
};

/// Cosine of half the angle between two rotations.
float half_cosine(const Quat& a, const Quat& b);

/// Whether two matches suggest nearly the same rotation and scale.
bool is_similar(const SurfaceMatch& a, const SurfaceMatch& b);

/// Takes each match in turn as true, and counts the others near their place in the view that it suggests.
/// \param tolerance_mm  distance on the surface at which a match still agrees.
/// \param views         out: the views with most votes, best first. Of nearly the same ones only the best is kept.
/// \return their number. Cost: matches^2 projections.
std::size_t find_views(Span<const SurfaceMatch> matches, const Camera& camera, float tolerance_mm,
                       Span<ViewVotes> views);

/// The view's second solution, where the surface is flat and perspective weak: tilted to the other side about the same
/// optical axis. \param front  rotation of the view that sees the surface from the front.
View mirrored_tilt(const View& view, Quat front);

}  // namespace pliant
