// One-dimensional search for an edge along its normal (docs/algorithms.md, section 7.4). The paper's edge tracker searches for
// zeros of the second derivative; they are the maxima of the first, which are searched for here.
#include "pliant/edges.hpp"

#include "base/integers.hpp"
#include "vision/edge_profile.hpp"
#include "vision/edge_tuning.hpp"

namespace pliant {
namespace {

struct Candidate {
  float t;         // steps from the prediction
  float contrast;  // grey levels, signed
  float variance;  // of t
  bool is_sharp;   // the maximum is so sharp that its variance is valid
  float weight;    // preference
};

// Position of the maximum of a bell-shaped function, from its values at -1, 0 and 1. A parabola through the values and one
// through their inverses have nearly opposite errors of up to a twentieth of a step. The mean of both is returned.
float peak_of(float before, float at, float after) {
  const float direct = 0.5f * (after - before) / (2 * at - before - after);
  if (!(before > 0 && after > 0)) return direct;
  const float b = 1 / before, m = 1 / at, a = 1 / after;
  return 0.5f * (direct + 0.5f * (b - a) / (b + a - 2 * m));
}

// exp(-u), by the first terms of exp(u).
float bell(float u) {
  return 1 / (1 + u * (1 + u * (0.5f + u * (1.0f / 6))));
}

// The step i of the profile as an edge; false if there is no maximum that stands out of the noise.
bool edge_at(const EdgeProfile& p, int i, float noise, const NoiseGain& gain, Candidate& c) {
  constexpr float kPerGrey = 1.0f / (3 * kProfileLines * kProfileGreyScale);
  constexpr float kMinBend = kEdgeTuning.min_bend_sd * kEdgeTuning.min_bend_sd;
  constexpr float kMinDerivative = kEdgeTuning.min_derivative_sd * kEdgeTuning.min_derivative_sd;
  const std::int32_t sign = p.derivative[i] < 0 ? -1 : 1;
  const std::int32_t before = sign * p.derivative[i - 1], at = sign * p.derivative[i],
                     after = sign * p.derivative[i + 1];
  if (!(at > before && at >= after)) return false;
  const auto b = static_cast<float>(before), m = static_cast<float>(at), a = static_cast<float>(after);
  const float offset = peak_of(b, m, a), bend = 2 * m - b - a, height = m + 0.25f * (a - b) * offset;
  c.t = static_cast<float>(p.first + i) + offset;
  c.contrast = static_cast<float>(sign) * kPerGrey * height;
  c.variance = 0.25f * gain.difference * noise / (bend * bend);
  c.is_sharp = bend * bend > kMinBend * gain.bend * noise;
  return height * height > kMinDerivative * gain.derivative * noise;
}

// Whether an edge can be the remembered one, by sign and size of its contrast.
bool is_like(float contrast, const EdgePoint& point, const EdgeOptions& o) {
  if (point.contrast == 0) return true;
  const float ratio = contrast / (255 * point.contrast);
  return ratio >= o.min_ratio && ratio <= o.max_ratio;
}

// The best candidates, best first. One more than the number of hypotheses, to detect ambiguity.
struct Ranking {
  Candidate best[kMaxEdgeHypotheses + 1];
  int count = 0;

  void add(const Candidate& c) {
    constexpr int kRoom = kMaxEdgeHypotheses + 1;
    if (count == kRoom && !(c.weight > best[kRoom - 1].weight)) return;
    int i = count < kRoom ? count++ : kRoom - 1;
    for (; i > 0 && c.weight > best[i - 1].weight; --i) best[i] = best[i - 1];
    best[i] = c;
  }
  int count_above(float fraction) const {
    int n = 0;
    while (n < count && best[n].weight >= fraction * best[0].weight) ++n;
    return n;
  }
};

// The search of one point: on which level, how far, and along which unit normal.
struct Search {
  Vec2 normal;
  float deviation;  // of the prediction along it, px
  float range;      // px
  int level;

  float scale() const { return static_cast<float>(1 << level); }
};

// \return false for a point that is not a number or has no normal.
bool plan(const Pyramid& pyramid, const EdgePoint& point, const EdgeOptions& o, Search& s) {
  const Sym2& c = point.covariance;
  const float size = length(point.normal);
  if (!is_finite(point.x) || !is_finite(size) || !(size > 0) || !is_finite(point.contrast)) return false;
  s.normal = (1 / size) * point.normal;
  const Vec2 n = s.normal;
  const float variance = n.x * n.x * c.xx + 2 * n.x * n.y * c.xy + n.y * n.y * c.yy;
  if (!is_finite(variance)) return false;
  s.deviation = square_root(variance);
  s.range = clamp(kEdgeTuning.range_sd * s.deviation, kEdgeTuning.min_range_px, kEdgeTuning.max_range_px);
  s.level = 0;
  while (s.level < o.finest_level && s.level + 1 < pyramid.levels()) ++s.level;
  while (s.level + 1 < pyramid.levels() && s.range > kMaxProfileReach * s.scale()) ++s.level;
  return true;
}

// Ranks all edges of the profile that stand out and are like the remembered one. \return found, or why there is none.
Reason rank_edges(const EdgeProfile& profile, const Search& s, const EdgePoint& point, const EdgeOptions& o,
                  Ranking& ranking) {
  constexpr float kFloor = kProfileGreyScale * kEdgeTuning.noise_floor_grey;
  constexpr float kIndifference = kEdgeTuning.indifference_px * kEdgeTuning.indifference_px;
  const NoiseGain& gain = s.level == 0 ? kWhiteNoiseGain : kSmoothedNoiseGain;
  const float noise = max(profile.noise, kSampledNoise * (kFloor * kFloor));
  const float spread = (s.deviation * s.deviation + kIndifference) / (s.scale() * s.scale());
  const float range = (s.range + 0.5f) / s.scale();
  Reason reason = Reason::no_texture;
  for (int i = 1; i + 1 < profile.count; ++i) {
    Candidate c;
    if (!edge_at(profile, i, noise, gain, c)) continue;
    if (magnitude(c.t) > range || magnitude(c.contrast) < kEdgeTuning.min_step_grey) continue;
    c.weight = magnitude(c.contrast) * bell(0.5f * c.t * c.t / spread);
    if (is_like(c.contrast, point, o))
      ranking.add(c);
    else
      reason = Reason::low_correlation;
  }
  return ranking.count > 0 ? Reason::found : reason;
}

Reason search_level(const Pyramid& pyramid, const EdgePoint& point, const EdgeOptions& o, const Search& s,
                    Ranking& ranking) {
  const ImageView& image = pyramid.level(s.level);
  const Vec2 x = (1 / s.scale()) * point.x;
  const bool is_inside = x.x >= 0 && x.y >= 0 && x.x < static_cast<float>(image.width - 1) &&
                         x.y < static_cast<float>(image.height - 1);
  if (!is_inside) return Reason::outside_image;
  EdgeProfile profile;
  sample_profile(image, x, s.normal, static_cast<int>(min(s.range / s.scale(), kMaxProfileReach) + 0.999f),
                 profile);
  if (profile.count == 0) return Reason::outside_image;
  return rank_edges(profile, s, point, o, ranking);
}

// An edge that noise and blur leave without a sharp maximum has one on a coarser level, or nowhere.
Reason search(const Pyramid& pyramid, const EdgePoint& point, const EdgeOptions& o, Search& s,
              Ranking& ranking) {
  if (!plan(pyramid, point, o, s)) return Reason::not_visible;
  Reason first = Reason::outside_image;
  for (const int finest = s.level; s.level < pyramid.levels(); ++s.level) {
    ranking.count = 0;
    const Reason reason = search_level(pyramid, point, o, s, ranking);
    if (reason == Reason::found && ranking.best[0].is_sharp) return reason;
    if (s.level == finest) first = reason == Reason::found ? Reason::no_texture : reason;
    if (first != Reason::no_texture) return first;
  }
  return first;
}

Observation observation_of(const Candidate& c, const Search& s, const EdgePoint& point) {
  constexpr float kFloor = kEdgeTuning.position_floor_px * kEdgeTuning.position_floor_px;
  Observation r;
  const Vec2 n = s.normal;
  r.id = point.id;
  r.cue = Cue::edge;
  r.x = point.x + (s.scale() * c.t) * n;
  const float w = 1 / (s.scale() * s.scale() * c.variance + kFloor);
  r.information = {w * n.x * n.x, w * n.x * n.y, w * n.y * n.y};
  r.score = clamp(c.contrast / 255, -1, 1);
  return r;
}

Observation nothing_found(const EdgePoint& point, Reason reason) {
  Observation r;
  r.id = point.id;
  r.x = point.x;
  r.cue = Cue::edge;
  r.reason = reason;
  return r;
}

}  // namespace

int find_edge(const Pyramid& pyramid, const EdgePoint& point, const EdgeOptions& o, Span<Observation> out) {
  if (out.count == 0) return 0;
  Search s;
  Ranking ranking;
  Reason reason = search(pyramid, point, o, s, ranking);
  const int most = within(o.hypotheses, 1, kMaxEdgeHypotheses);
  if (reason == Reason::found && ranking.count_above(kEdgeTuning.ambiguous_fraction) > most)
    reason = Reason::ambiguous;
  if (reason != Reason::found) {
    out[0] = nothing_found(point, reason);
    return 1;
  }
  const int kept = ranking.count_above(kEdgeTuning.min_alternative_fraction);
  int n = 0;
  for (; n < kept && n < most && static_cast<std::size_t>(n) < out.count; ++n)
    out[static_cast<std::size_t>(n)] = observation_of(ranking.best[n], s, point);
  return n;
}

}  // namespace pliant
