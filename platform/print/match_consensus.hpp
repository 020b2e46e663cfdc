#pragma once
// Views of a surface that many matches agree on (docs/algorithms.md, section 7.17).
#include <cstddef>
#include <cstdint>

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

/// Matches, the best ones first, and their order by scale.
struct ScaledMatches {
  Span<const SurfaceMatch> all;
  Span<std::uint16_t> order;  ///< indices, as many as matches

  /// Fills `order`. 0.5 million operations for 1,700 matches.
  void sort();
  const SurfaceMatch& operator[](std::size_t place) const { return all[order[place]]; }
};

/// Takes one match as true, and counts the others near their place in the view that it suggests. After all have been taken in turn
/// `views` are those with most votes, best first; of nearly the same ones only the best is kept.
/// \param place         of the match, in the order: matches of other scales are not compared.
/// \param tolerance_mm  distance on the surface at which a match still agrees.
/// \param count         of the views so far; 0 before the first match.
/// \return matches that were compared: 20 to 100 operations each.
std::uint32_t vote_for_view(const ScaledMatches& matches, std::size_t place, const Camera& camera,
                            float tolerance_mm, Span<ViewVotes> views, std::size_t* count);

/// The view's second solution, where the surface is flat and perspective weak: tilted to the other side about the same
/// optical axis. \param front  rotation of the view that sees the surface from the front.
View mirrored_tilt(const View& view, Quat front);

}  // namespace pliant
