#include "track/edge_search.hpp"

namespace pliant {

namespace {

float bright(const ChartImage& albedo, Vec2 uv) {
  const auto index = [](float t, std::uint32_t n) {
    return static_cast<std::uint32_t>(clamp(t, 0, 1) * static_cast<float>(n - 1) + 0.5f);
  };
  return static_cast<float>(
      albedo.pixels[index(uv.y, albedo.height) * albedo.width + index(uv.x, albedo.width)]);
}

/// The finest level on which edges are looked for. Lids and lips are soft: what is a step at a pixel a millimetre is a
/// slope with noise on it at two.
int finest_level(float px_per_mm) {
  constexpr float kMostPxPerMm = 1.4f;
  int level = 0;
  for (; px_per_mm > kMostPxPerMm && level < 4; px_per_mm *= 0.5f) ++level;
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

void EdgeSearch::lay_out(Arena& arena, std::size_t capacity) {
  edges_ = arena.take<Edge>(capacity);
  capacity_ = capacity;
  count_ = 0;
}

void EdgeSearch::place(Estimator& estimator, float spacing_mm, std::size_t silhouette_points) {
  constexpr std::size_t kMostOfCurve = 64;
  count_ = 0;
  const std::size_t of_curves = silhouette_points < capacity_ ? capacity_ - silhouette_points : 0;
  const auto take = [this](std::uint16_t id, bool is_silhouette) {
    edges_[count_++] = {id, 0, is_silhouette, true, true, 0, 0};
  };
  for (std::size_t c = 0; c < estimator.model().curves().count && count_ < of_curves; ++c) {
    if (estimator.model().curves()[c].kind == CurveKind::boundary) continue;
    std::uint16_t ids[kMostOfCurve];
    const std::size_t room = of_curves - count_;
    std::size_t n = 0;
    const Status status =
        estimator.add_curve(c, spacing_mm, {ids, room < kMostOfCurve ? room : kMostOfCurve}, &n);
    for (std::size_t k = 0; k < n; ++k) take(ids[k], false);
    if (status != Status::ok && status != Status::capacity) return;
  }
  for (std::size_t k = 0; k < silhouette_points && count_ < capacity_; ++k) {
    std::uint16_t id;
    if (estimator.add_silhouette_point(&id) != Status::ok) return;
    take(id, true);
  }
}

void EdgeSearch::anchor(Estimator& estimator, const Pyramid& pyramid, Vec2 origin) {
  for (std::size_t k = 0; k < count_; ++k) {
    Edge& edge = edges_[k];
    if (edge.is_silhouette) continue;
    const Prediction p = estimator.predict(edge.id);
    EdgeOptions options;
    options.hypotheses = 1;
    options.finest_level = finest_level(estimator.view().s);
    Observation seen;
    edge.is_used = p.visible &&
                   find_edge(pyramid, edge_point(p, p.x - origin, 1), options, {&seen, 1}) == 1 &&
                   seen.reason == Reason::found;
    if (!edge.is_used) continue;
    edge.any_contrast = false;
    edge.contrast = seen.score;
    edge.offset = dot(seen.x + origin - p.x, p.normal) / estimator.view().s;
  }
}

void EdgeSearch::expect_albedo(Estimator& estimator) {
  constexpr float kStepGrey = 6, kAsidePx = 2.5f;
  const ChartImage albedo = estimator.model().albedo();
  if (albedo.pixels == nullptr) return;
  for (std::size_t k = 0; k < count_; ++k) {
    Edge& edge = edges_[k];
    if (edge.is_silhouette) continue;
    const Prediction p = estimator.predict(edge.id);
    if (magnitude(determinant(p.jacobian)) < 1e-3f) continue;
    const Vec2 aside = inverse(p.jacobian) * (kAsidePx * p.normal), uv = estimator.point_uv(edge.id);
    const float step = bright(albedo, uv + aside) - bright(albedo, uv - aside);
    edge.is_used = magnitude(step) >= kStepGrey;
    edge.contrast = step / 255;
  }
}

std::size_t EdgeSearch::look(Span<const Prediction> predictions, const std::uint16_t* prediction_of,
                             const Pyramid& pyramid, Vec2 origin, float image_scale, float sd_px,
                             Span<Observation> out) {
  std::size_t n = 0;
  for (std::size_t k = 0; k < count_ && n + kAlternatives <= out.count; ++k) {
    Edge& edge = edges_[k];
    edge.count = 0;
    const Prediction& p = predictions[prediction_of[edge.id]];
    if (!edge.is_used || !p.visible) continue;
    const Vec2 beside = image_scale * edge.offset * p.normal;
    EdgePoint point = edge_point(p, p.x + beside - origin, sd_px);
    point.contrast = edge.contrast;
    EdgeOptions options;
    options.hypotheses = kAlternatives;
    options.finest_level = finest_level(image_scale);
    if (edge.any_contrast) {  // its sign counts, if that is known, and not its size
      options.min_ratio = 0;
      options.max_ratio = 1e6f;
    }
    const int found = find_edge(pyramid, point, options, {out.data + n, kAlternatives});
    for (int i = 0; i < found; ++i) {
      out[n].x = out[n].x + origin - beside;
      out[n].cue = Cue::edge;
      ++n;
    }
    edge.count = static_cast<std::uint8_t>(found);
  }
  return n;
}

void EdgeSearch::note(Span<const Observation> out) {
  constexpr float kRate = 0.1f;
  std::size_t n = 0;
  for (std::size_t k = 0; k < count_; ++k) {
    Edge& edge = edges_[k];
    for (std::size_t i = 0; i < edge.count; ++i, ++n)
      if (n < out.count && out[n].reason == Reason::found && !edge.any_contrast && !edge.is_silhouette)
        edge.contrast += kRate * (out[n].score - edge.contrast);
    edge.count = 0;
  }
}

}  // namespace pliant
