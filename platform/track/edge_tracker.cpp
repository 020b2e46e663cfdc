#include "track/edge_tracker.hpp"

#include "base/integers.hpp"
#include "estimate/track_monitor.hpp"
#include "track/template_tuning.hpp"
#include "track/tracker_parts.hpp"
#include "track/tracker_sizes.hpp"

namespace pliant {

namespace {

constexpr const EdgeTrackerTuning& kTuning = kEdgeTrackerTuning;

/// The finest pyramid level on which edges are matched at this image scale.
int finest_level(float px_per_mm) {
  int level = 0;
  for (; px_per_mm > kTuning.most_px_per_mm && level < kTuning.coarsest_level; px_per_mm *= 0.5f) ++level;
  return level;
}

EdgePoint edge_point(const Prediction& p, Vec2 x, float sd_px) {
  EdgePoint point;
  point.id = p.id;
  point.x = x;
  point.normal = p.normal;
  point.covariance = {sd_px * sd_px, 0, sd_px * sd_px};
  return point;
}

}  // namespace

void EdgeTracker::lay_out(Arena& arena, const TrackerLimits& limits) {
  capacity_ = edge_points(limits);
  silhouette_capacity_ = limits.silhouette_points;
  prediction_sd_px_ = scaled_px(limits, kTuning.prediction_sd_px);
  count_ = 0;
  arena.count_as(Purpose::points);
  edges_ = arena.take<Edge>(capacity_);
}

std::size_t EdgeTracker::start(Estimator& estimator, const FrameRegion& region) {
  add_points(estimator);
  std::size_t used = 0;
  for (std::size_t k = 0; k < count_; ++k) {
    if (!edges_[k].is_silhouette) capture_reference(edges_[k], estimator, region);
    used += edges_[k].is_used;
  }
  return used;
}

void EdgeTracker::add_points(Estimator& estimator) {
  count_ = 0;
  const std::size_t of_curves = capacity_ - silhouette_capacity_;
  const auto add = [this](std::uint16_t id, bool is_silhouette) {
    edges_[count_++] = {id, 0, is_silhouette, true, 0, 0};
  };
  const Span<const Curve> curves = estimator.model().curves();
  for (std::size_t c = 0; c < curves.count && count_ < of_curves; ++c) {
    if (curves[c].kind == CurveKind::boundary) continue;
    std::uint16_t ids[kTuning.most_of_curve];
    std::size_t n = 0;
    const Status status = estimator.add_curve(c, kTuning.spacing_mm,
                                              {ids, smaller(of_curves - count_, kTuning.most_of_curve)}, &n);
    for (std::size_t k = 0; k < n; ++k) add(ids[k], false);
    if (status != Status::ok && status != Status::capacity) return;
  }
  for (std::size_t k = 0; k < silhouette_capacity_ && count_ < capacity_; ++k) {
    std::uint16_t id;
    if (estimator.add_silhouette_point(&id) != Status::ok) return;
    add(id, true);
  }
}

void EdgeTracker::capture_reference(Edge& edge, Estimator& estimator, const FrameRegion& region) const {
  const Prediction p = estimator.predict(edge.id);
  EdgeOptions options;
  options.hypotheses = 1;
  options.finest_level = finest_level(estimator.view().s);
  Observation seen;
  edge.is_used =
      p.visible &&
      find_edge(region.pyramid(), edge_point(p, p.x - region.origin(), 1), options, {&seen, 1}) == 1 &&
      seen.reason == Reason::found;
  if (!edge.is_used) return;
  edge.contrast = seen.score;
  edge.offset = dot(seen.x + region.origin() - p.x, p.normal) / estimator.view().s;
}

std::size_t EdgeTracker::match(const PredictionTable& predictions, const FrameRegion& region,
                               float image_scale, Span<Observation> out) {
  EdgeOptions options;
  options.hypotheses = kAlternatives;
  options.finest_level = finest_level(image_scale);
  std::size_t n = 0;
  for (std::size_t k = 0; k < count_ && n + kAlternatives <= out.count; ++k) {
    Edge& edge = edges_[k];
    edge.count = 0;
    const Prediction& p = predictions[edge.id];
    if (!edge.is_used || !p.visible) continue;
    const Vec2 beside = image_scale * edge.offset * p.normal;
    EdgePoint point = edge_point(p, p.x + beside - region.origin(), prediction_sd_px_);
    point.contrast = edge.contrast;
    const int found = find_edge(region.pyramid(), point, options, {out.data + n, kAlternatives});
    for (int i = 0; i < found; ++i, ++n) out[n].x = out[n].x + region.origin() - beside;
    edge.count = static_cast<std::uint8_t>(found);
  }
  return n;
}

void EdgeTracker::end_frame(Span<const Observation> out) {
  std::size_t n = 0;
  for (std::size_t k = 0; k < count_; ++k) {
    Edge& edge = edges_[k];
    for (std::size_t i = 0; i < edge.count; ++i, ++n)
      if (n < out.count && out[n].reason == Reason::found && !edge.is_silhouette)
        edge.contrast += kTuning.contrast_rate * (out[n].score - edge.contrast);
    edge.count = 0;
  }
}

namespace {

EdgeTracker* lay_out(Arena& arena, const TrackerLimits& limits) {
  return create_part<EdgeTracker>(arena, limits);
}

void start_late(TrackerParts& t, const FrameView&) {
  if (t.progress.bad_frames > 0) return;  // the surface is not where the estimator has it
  t.progress.rest = nullptr;
  t.edges->start(t.estimator, t.region);
}

std::size_t start(TrackerParts& t, std::size_t templates) {
  constexpr int kEnough = larger(kTrackerTuning.least_templates, kTrackMonitorTuning.least_inliers);
  if (!t.limits.keeps_previous || templates < kEnough) return t.edges->start(t.estimator, t.region);
  t.progress.rest = start_late;
  return 0;
}

}  // namespace

const EdgeMatching kEdgeMatching{lay_out, start, &EdgeTracker::match, &EdgeTracker::end_frame};

}  // namespace pliant
