// One-dimensional search for an edge along its normal (ALGORITHMS: moving edges; the paper's edge tracker looks for the
// zeros of the second derivative). What is usual is one line of samples; a strip of five costs little, halves the noise,
// and says by the differences across it how large that noise is here, from which the variance of the result follows.
#include "pliant/edges.hpp"

namespace pliant {
namespace {

constexpr int kReach = 16;  // steps to either side that are searched, at most
constexpr int kBorder = 3;  // samples that a derivative and its two neighbours need besides
constexpr int kHalfWidth = 2, kLines = 2 * kHalfWidth + 1;
constexpr int kSamples = 2 * (kReach + kBorder) + 1;
constexpr int kBits = 16;       // fractional bits of positions
constexpr int kGreyScale = 16;  // samples are in sixteenths of a grey
// The kernel (-1 -2 0 2 1) makes of a step 3 times its height.
constexpr float kPerGrey = 1.0f / (3 * kLines * kGreyScale);

// By how much the sums over the strip amplify the noise of its samples, as variances: neighbouring samples share pixels.
struct Amplification {
  float derivative;  // weights -1 -2 0 2 1 along the strip
  float difference;  // of the derivatives on both sides: 1 2 -1 -4 -1 2 1
  float bend;        // their second difference: -1 0 3 0 -3 0 1
};
// From the correlation of samples one and two pixels apart.
constexpr Amplification amplification(float one, float two) {
  const float lines = 5 + 8 * one + 6 * two;
  return {lines * (10 + 8 * one - 8 * two), lines * (28 + 16 * one - 34 * two), lines * (20 - 30 * two)};
}
// White noise sampled between pixels, on average over phases; smoothed by a pyramid, it is correlated by itself.
constexpr Amplification kWhite = amplification(0.25f, 0), kSmoothed = amplification(0.6f, 0.1f);
constexpr float kSampled = 4.0f / 9;  // of its variance that sampling leaves

// What a derivative and its bend must stand out by, in standard deviations. The second is what makes a position one:
// with less, noise chooses among the places on a flat top.
constexpr float kSignificant = 4.5f, kSharp = 6;

struct Fixed {
  int x, y;
};

Fixed fixed(Vec2 v) {
  return {static_cast<int>(v.x * (1 << kBits)), static_cast<int>(v.y * (1 << kBits))};
}

// The strip in the image: sample (j, t) lies at origin + j * across + t * along.
struct Strip {
  Fixed origin, along, across;

  Fixed at(int j, int t) const {
    return {origin.x + j * across.x + t * along.x, origin.y + j * across.y + t * along.y};
  }
};

// Before a position is made an integer.
bool contains(const ImageView& image, Vec2 x) {
  return x.x >= 0 && x.y >= 0 && x.x < static_cast<float>(image.width - 1) &&
         x.y < static_cast<float>(image.height - 1);
}

bool is_inside(const ImageView& image, Fixed p) {
  return p.x >= 0 && p.y >= 0 && p.x < (image.width - 1) << kBits && p.y < (image.height - 1) << kBits;
}

// In sixteenths of a grey.
int bilinear(const ImageView& image, Fixed p) {
  const std::uint8_t* q = image.data + std::ptrdiff_t{p.y >> kBits} * image.stride + (p.x >> kBits);
  const int fx = (p.x >> (kBits - 8)) & 255, fy = (p.y >> (kBits - 8)) & 255;
  const int upper = q[0] * 256 + (q[1] - q[0]) * fx;
  const int lower = q[image.stride] * 256 + (q[image.stride + 1] - q[image.stride]) * fx;
  return (upper * 256 + (lower - upper) * fy + 2048) >> 12;
}

// Derivatives along the strip at the steps [first, first + count).
struct Profile {
  int first = 0, count = 0;
  std::int32_t derivative[kSamples];
  float noise = 0;  // variance of a sample, in units of the samples squared
};

// How far the strip lies in the image on the side of `sign`, in steps, up to `most`; -1: not even its middle.
int steps_inside(const ImageView& image, const Strip& strip, int sign, int most) {
  int t = 0;
  while (t <= most && is_inside(image, strip.at(-kHalfWidth, sign * t)) &&
         is_inside(image, strip.at(kHalfWidth, sign * t)))
    ++t;
  return t - 1;
}

// Fills the profile for `reach` steps either way, or as far as the image goes.
void sample(const ImageView& image, const Strip& strip, int reach, Profile& profile) {
  const int low = -steps_inside(image, strip, -1, reach + kBorder);
  const int high = steps_inside(image, strip, 1, reach + kBorder);
  if (low > -kBorder || high < kBorder) return;  // not even the expected place can be seen
  std::int32_t sum[kSamples];
  std::int64_t roughness = 0;
  for (int t = low; t <= high; ++t) {
    int v[kLines];
    for (int j = 0; j < kLines; ++j) v[j] = bilinear(image, strip.at(j - kHalfWidth, t));
    sum[t - low] = v[0] + v[1] + v[2] + v[3] + v[4];
    const int bend = v[0] - 2 * v[2] + v[4];
    roughness += std::int64_t{bend} * bend;
  }
  const int samples = high - low + 1;
  profile.first = low + 2;
  profile.count = samples - 4;
  for (int i = 0; i < profile.count; ++i)
    profile.derivative[i] = sum[i + 4] - sum[i] + 2 * (sum[i + 3] - sum[i + 1]);
  profile.noise = static_cast<float>(roughness) / static_cast<float>(6 * samples);
}

struct Candidate {
  float t;         // steps from the prediction
  float contrast;  // grey, signed
  float variance;  // of t
  bool is_sharp;   // its variance can be believed
  float weight;    // preference
};

// Where a bell has its maximum, from its value at -1, 0 and 1: parabolas through the values and through their inverses
// err to opposite sides by nearly the same, up to a twentieth of a step.
float peak_of(float before, float at, float after) {
  const float direct = 0.5f * (after - before) / (2 * at - before - after);
  if (!(before > 0 && after > 0)) return direct;
  const float b = 1 / before, m = 1 / at, a = 1 / after;
  return 0.5f * (direct + 0.5f * (b - a) / (b + a - 2 * m));
}

// exp(-u), roughly.
float bell(float u) {
  return 1 / (1 + u * (1 + u * (0.5f + u * (1.0f / 6))));
}

// The step i of the profile as an edge; false where there is no maximum that stands out.
bool edge_at(const Profile& p, int i, float noise, const Amplification& by, Candidate& c) {
  const std::int32_t sign = p.derivative[i] < 0 ? -1 : 1;
  const std::int32_t before = sign * p.derivative[i - 1], at = sign * p.derivative[i],
                     after = sign * p.derivative[i + 1];
  if (!(at > before && at >= after)) return false;
  const auto b = static_cast<float>(before), m = static_cast<float>(at), a = static_cast<float>(after);
  const float offset = peak_of(b, m, a), bend = 2 * m - b - a, height = m + 0.25f * (a - b) * offset;
  c.t = static_cast<float>(p.first + i) + offset;
  c.contrast = static_cast<float>(sign) * kPerGrey * height;
  c.variance = 0.25f * by.difference * noise / (bend * bend);
  c.is_sharp = bend * bend > kSharp * kSharp * by.bend * noise;
  return height * height > kSignificant * kSignificant * by.derivative * noise;
}

bool is_like(float contrast, const EdgePoint& point, const EdgeOptions& o) {
  if (point.contrast == 0) return true;
  const float ratio = contrast / (255 * point.contrast);
  return ratio >= o.min_ratio && ratio <= o.max_ratio;
}

// The best candidates, best first: one more than hypotheses there can be, to see what is ambiguous.
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
  int count_above(float share) const {
    int n = 0;
    while (n < count && best[n].weight >= share * best[0].weight) ++n;
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

bool plan(const Pyramid& pyramid, const EdgePoint& point, const EdgeOptions& o, Search& s) {
  const Sym2& c = point.covariance;
  const float size = length(point.normal);
  if (!is_finite(point.x) || !is_finite(size) || !(size > 0) || !is_finite(point.contrast)) return false;
  s.normal = (1 / size) * point.normal;
  const Vec2 n = s.normal;
  const float variance = n.x * n.x * c.xx + 2 * n.x * n.y * c.xy + n.y * n.y * c.yy;
  if (!is_finite(variance)) return false;
  s.deviation = square_root(variance);
  s.range = max(min(max(o.range_sd * s.deviation, o.min_range_px), o.max_range_px), 0);
  s.level = 0;
  while (s.level < o.finest_level && s.level + 1 < pyramid.levels()) ++s.level;
  while (s.level + 1 < pyramid.levels() && s.range > kReach * s.scale()) ++s.level;
  return true;
}

// All edges of the profile that stand out and are like the one remembered. Gives why there is none.
Reason collect(const Profile& profile, const Search& s, const EdgePoint& point, const EdgeOptions& o,
               Ranking& ranking) {
  const Amplification& by = s.level == 0 ? kWhite : kSmoothed;
  const float floor = kGreyScale * o.noise_floor_grey;
  const float noise = max(profile.noise, kSampled * max(floor * floor, 1));
  const float spread =
      (s.deviation * s.deviation + o.indifference_px * o.indifference_px) / (s.scale() * s.scale());
  const float range = (s.range + 0.5f) / s.scale();
  Reason reason = Reason::no_texture;
  for (int i = 1; i + 1 < profile.count; ++i) {
    Candidate c;
    if (!edge_at(profile, i, noise, by, c)) continue;
    if (magnitude(c.t) > range || magnitude(c.contrast) < o.min_step_grey) continue;
    c.weight = magnitude(c.contrast) * bell(0.5f * c.t * c.t / max(spread, 1e-6f));
    if (is_like(c.contrast, point, o))
      ranking.add(c);
    else
      reason = Reason::low_correlation;
  }
  return ranking.count > 0 ? Reason::found : reason;
}

Observation observation_of(const Candidate& c, const Search& s, const EdgePoint& point,
                           const EdgeOptions& o) {
  Observation r;
  const Vec2 n = s.normal;
  r.id = point.id;
  r.cue = Cue::edge;
  r.x = point.x + (s.scale() * c.t) * n;
  const float w = 1 / (s.scale() * s.scale() * c.variance + o.position_floor_px * o.position_floor_px);
  r.information = {w * n.x * n.x, w * n.x * n.y, w * n.y * n.y};
  r.score = clamp(c.contrast / 255, -1, 1);
  return r;
}

Reason look_on_level(const Pyramid& pyramid, const EdgePoint& point, const EdgeOptions& o, const Search& s,
                     Ranking& ranking) {
  const ImageView& image = pyramid.level(s.level);
  const Vec2 x = (1 / s.scale()) * point.x;
  if (!contains(image, x)) return Reason::outside_image;
  const Strip strip{fixed(x), fixed(s.normal), fixed({-s.normal.y, s.normal.x})};
  Profile profile;
  sample(image, strip, static_cast<int>(min(s.range / s.scale(), kReach) + 0.999f), profile);
  if (profile.count == 0) return Reason::outside_image;
  return collect(profile, s, point, o, ranking);
}

// An edge that noise and blur leave without a sharp maximum has one on a coarser level, or nowhere.
Reason look(const Pyramid& pyramid, const EdgePoint& point, const EdgeOptions& o, Search& s,
            Ranking& ranking) {
  if (!plan(pyramid, point, o, s)) return Reason::not_visible;
  Reason first = Reason::outside_image;
  for (const int finest = s.level; s.level < pyramid.levels(); ++s.level) {
    ranking.count = 0;
    const Reason reason = look_on_level(pyramid, point, o, s, ranking);
    if (reason == Reason::found && ranking.best[0].is_sharp) return reason;
    if (s.level == finest) first = reason == Reason::found ? Reason::no_texture : reason;
    if (first != Reason::no_texture) return first;
  }
  return first;
}

}  // namespace

int find_edge(const Pyramid& pyramid, const EdgePoint& point, const EdgeOptions& o, Span<Observation> out) {
  if (out.count == 0) return 0;
  Search s;
  Ranking ranking;
  Reason reason = look(pyramid, point, o, s, ranking);
  const int most = o.hypotheses < 1                    ? 1
                   : o.hypotheses > kMaxEdgeHypotheses ? kMaxEdgeHypotheses
                                                       : o.hypotheses;
  if (reason == Reason::found && ranking.count_above(o.ambiguous_fraction) > most) reason = Reason::ambiguous;
  if (reason != Reason::found) {
    out[0] = {};
    out[0].id = point.id;
    out[0].x = point.x;
    out[0].cue = Cue::edge;
    out[0].reason = reason;
    return 1;
  }
  const int kept = ranking.count_above(o.keep_fraction);
  int n = 0;
  for (; n < kept && n < most && static_cast<std::size_t>(n) < out.count; ++n)
    out[static_cast<std::size_t>(n)] = observation_of(ranking.best[n], s, point, o);
  return n;
}

}  // namespace pliant
