#pragma once
/// \file edges.hpp
/// The edge tracker: where, along the normal of an expected edge, is the edge in the picture?
///
/// The picture is sampled on a strip across the edge, five samples wide, one pixel a step, and differentiated with the
/// antisymmetric kernel (-1 -2 0 2 1). Edges are the maxima of its magnitude, the zeros of the second derivative, to a
/// fraction of a step by a parabola. Samples and derivatives are integers; the bits are the same on every target.
#include <cstdint>

#include "pliant/geometry.hpp"
#include "pliant/observation.hpp"
#include "pliant/pyramid.hpp"
#include "pliant/status.hpp"

namespace pliant {

/// Where an edge is expected: a point of a silhouette, a lid, a lip, a brow.
struct EdgePoint {
  std::uint16_t id = 0;  ///< given to the observations
  Vec2 x;                ///< predicted image position, px
  Vec2 normal;           ///< of the edge in the image; of any length but zero
  Sym2 covariance;       ///< of x, px^2; what of it lies along the normal sets the range of the search
  /// Score of the observation that was last taken for this edge: its sign and its size are asked for again, the size
  /// between min_ratio and max_ratio. 0: never seen, any edge will do.
  float contrast = 0;
};

struct EdgeOptions {
  float range_sd = 3;  ///< how many standard deviations to search to either side
  float min_range_px = 2, max_range_px = 24;
  /// A step of so many grey levels, at least. An edge must also stand 4.5 standard deviations out of the local noise.
  float min_step_grey = 8;
  float min_ratio = 0.5f, max_ratio = 2;  ///< of an edge's contrast to the one remembered
  /// Edges so near to the prediction are all alike: added (in squares) to its deviation for the preference of near edges.
  float indifference_px = 1;
  int finest_level = 0;     ///< of the pyramid, on which to look at all
  int hypotheses = 2;       ///< alternatives given at most, 1 to kMaxEdgeHypotheses
  float keep_fraction = 0.5f;  ///< of the best one's preference, that an alternative must reach
  float ambiguous_fraction =
      0.8f;  ///< more than `hypotheses` edges that reach this share of the best: none is given
  float noise_floor_grey = 1;       ///< the noise of a pixel counts as at least this
  float position_floor_px = 0.05f;  ///< standard deviation that no result claims to be better than
};

constexpr int kMaxEdgeHypotheses = 4;

/// Looks for the edge. The search runs on the finest level on which its range fits into 16 steps to either side; nearer
/// edges are preferred by a bell of the prediction's deviation.
/// \param out  room for at least one observation, which is always written: with reason `found`, or why there is none:
///             `not_visible` for a normal of no length or anything not finite, `outside_image` where the strip does not
///             fit around x, `no_texture` where no edge stands out, `low_correlation` where those that do are not like
///             the one remembered, `ambiguous`. Further ones, with the same id, are alternatives, best first.
///             `information` is of rank one, along the normal; `score` is the step's height in greys over 255, positive
///             where the picture is brighter on the side that the normal points to: blur lowers it.
/// \return the number of observations written; 0 only for no room.
/// Cost: 5 bilinear samples a step: about 1 us for a range of 6 px on a desktop core. Nothing is allocated.
int find_edge(const Pyramid& pyramid, const EdgePoint& point, const EdgeOptions& options,
              Span<Observation> out);

}  // namespace pliant
