#pragma once
/// \file edges.hpp
/// The edge finder: where along the normal of an expected edge the image has an edge.
///
/// The image is sampled on a strip across the edge, five samples wide, in steps of one pixel, and differentiated with
/// the antisymmetric kernel (-1 -2 0 2 1) (docs/algorithms.md, section 7.4). Edges are the maxima of the derivative's
/// magnitude, located to a fraction of a step by a parabola. Samples and derivatives are integers: the bits are the
/// same on every target.
#include <cstdint>

#include "pliant/geometry.hpp"
#include "pliant/observation.hpp"
#include "pliant/pyramid.hpp"
#include "pliant/status.hpp"

namespace pliant {

/// An expected edge: a point of a silhouette, a lid, a lip or a brow.
struct EdgePoint {
  std::uint16_t id = 0;  ///< copied to the observations
  Vec2 x;                ///< predicted image position, px
  Vec2 normal;           ///< of the edge in the image; of any length from 1e-18 to 1e18
  /// Of x, px^2. The search range is three standard deviations along the normal, at least 2 and at most 24 px.
  Sym2 covariance;
  /// The `score` of the observation that was last used for this edge. Only edges of the same sign and of a similar size
  /// (EdgeOptions::min_ratio to max_ratio) are then accepted. 0: any edge is.
  float contrast = 0;
};

/// Options of find_edge.
struct EdgeOptions {
  /// Accepted ratio of an edge's contrast to the remembered one. Round values, not tuned.
  float min_ratio = 0.5f, max_ratio = 2;
  int finest_level = 0;  ///< pyramid level on which the search starts, at least; 0: full size
  int hypotheses = 2;    ///< alternatives given, at most; 1 to kMaxEdgeHypotheses
};

constexpr int kMaxEdgeHypotheses = 4;  ///< most alternatives of one edge

/// Finds an edge along the normal of `point`. The search starts on the finest level on which its range fits into 16
/// steps to either side. It continues on coarser levels if the edge is too blurred. Of several edges, those that are
/// nearer to x and stronger are preferred.
/// \param out  At least one observation is written: with reason `found`, or with the reason why there is none:
///         `not_visible` for a normal out of these lengths or values that are not finite; `outside_image` if the strip does
///         not fit around x; `no_texture` if no edge stands out of the noise; `low_correlation` if those that do are
///         not like the remembered one; `ambiguous` if more edges than `hypotheses` are equally good. Further
///         observations have the same id and are alternatives, best first. `information` is of rank one, along the
///         normal. `score` is the step in grey levels over 255, positive if the image is brighter on the side of the
///         normal; blur lowers it.
/// \return the number of observations written; 0 only if `out` is empty.
/// Cost: 5 bilinear samples a step, about 1 us for a range of 6 px on a desktop core. Nothing is allocated.
int find_edge(const Pyramid& pyramid, const EdgePoint& point, const EdgeOptions& options,
              Span<Observation> out);

}  // namespace pliant
