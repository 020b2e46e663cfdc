#pragma once
/// \file edge_tracker.hpp
/// Matches the model's curves (lids, lips, brows) and its silhouette (docs/algorithms.md, section 7.4).
#include <cstddef>
#include <cstdint>

#include "pliant/edges.hpp"
#include "pliant/estimator.hpp"
#include "track/frame_region.hpp"
#include "track/template_matcher.hpp"

namespace pliant {

/// Tuning of edges. Each constant: unit, reason, experiment.
struct EdgeTrackerTuning {
  /// Distance of edge points along a curve on the surface, mm. Points closer together measure the same edge.
  float spacing_mm = 4;
  /// Edge points of one curve, at most: the room on the stack for their ids.
  std::size_t most_of_curve = 64;
  /// Standard deviation of an edge's prediction across the edge once templates are solved for, px at 320 px
  /// of image width: it sets the search's range. Chosen on the rendered film of which half has no texture.
  float prediction_sd_px = 1.5f;
  /// Pixels per mm above which edges are matched on a coarser pyramid level. Lids and lips are soft: a step
  /// at a pixel a millimetre is a noisy slope at two. Chosen on the Talking Face video at two sizes.
  float most_px_per_mm = 1.4f;
  /// Coarsest level for that, beyond the three levels of a default pyramid. A level that the pyramid does not have is left out
  /// by find_edge.
  int coarsest_level = 4;
  /// Fraction by which a matched edge's contrast moves its reference, a frame. Round value, not tuned.
  float contrast_rate = 0.1f;
};
inline constexpr EdgeTrackerTuning kEdgeTrackerTuning{};

/// Edge points and their references: what each looked like in frame 0.
class EdgeTracker {
 public:
  /// Observations of one edge point, at most: alternatives.
  static constexpr std::size_t kAlternatives = 2;

  void lay_out(Arena& arena, const TrackerLimits& limits);

  /// Frame 0: adds edge points along the model's curves and around its silhouette to the estimator, as far as there is
  /// room. A point of a curve takes its contrast in this frame as reference, and its offset from the model's curve; one
  /// without an edge is not matched later. \return how many will be matched.
  std::size_t start(Estimator& estimator, const FrameRegion& region);
  /// Nothing is matched until the next start: the estimator has no points of the edges any more.
  void forget() { count_ = 0; }

  /// Matches all edge points. \param image_scale  of the view, px per mm. \return how many observations were written.
  std::size_t match(const PredictionTable& predictions, const FrameRegion& region, float image_scale,
                    Span<Observation> out);
  /// Updates the references' contrast. \param out  as `match` wrote them and the last solve judged them.
  void end_frame(Span<const Observation> out);

  std::size_t count() const { return count_; }

 private:
  struct Edge {
    std::uint16_t id;
    std::uint8_t count;  // of its observations, which follow those of the edge before
    bool is_silhouette, is_used;
    float contrast;
    float offset;  // along the normal, px at an image scale of one
  };

  void add_points(Estimator& estimator);
  void capture_reference(Edge& edge, Estimator& estimator, const FrameRegion& region) const;

  Edge* edges_ = nullptr;
  std::size_t capacity_ = 0, silhouette_capacity_ = 0, count_ = 0;
  float prediction_sd_px_ = 0;
};

struct TrackerParts;

/// Makes an edge tracker, and a tracker's calls to it (`kEdgeMatching`, tracker_limits.hpp).
struct EdgeMatching {
  EdgeTracker* (*lay_out)(Arena& arena, const TrackerLimits& limits);
  /// Ends a start, in the picture that the region has. A start is the longest frame: where it has captured enough templates and
  /// pictures last, edges are left to the next frame. \return how many will be matched in it.
  std::size_t (*start)(TrackerParts& tracker, std::size_t templates);
  std::size_t (EdgeTracker::*match)(const PredictionTable& predictions, const FrameRegion& region,
                                    float image_scale, Span<Observation> out);
  void (EdgeTracker::*end_frame)(Span<const Observation> out);
};

}  // namespace pliant
