// The last steps, at full size: what cheap alignment leaves is the phase error of bilinear sampling and the
// pull of a warp that nobody predicted. Here the image is sampled by cubic convolution and explained as
//   I' = gain T' + sum_k c_k X_k' + a . G',        X = (x gx, y gx, x gy, y gy),
// by least squares; the shift is then -a / gain. The c have a prior: what the template has not been put through of the
// warp predicted, as if the gain were one. Leaving them free costs a
// tenth of the precision and removes nearly all of the error that a rotation of 1.5 degrees or a stretch of 1
// % makes, which would be larger than that of noise of three grey levels.
#include <new>

#include "vision/patch_work.hpp"

namespace pliant::patch {
namespace {

constexpr int kWithoutStretch = 3;   // motions
constexpr float kPriorNoise = 2.0f;  // grey levels, for the weight of the prior on the warp

// Sums over the template's images, `m` of them, shift last: [light, stretch..., shift] or [light, shift].
struct Moments {
  const std::int16_t* images[kMotions];
  const std::int16_t* mask;
  int m;
  std::int64_t n;
  float inverse_n;
  std::int32_t sums[kMotions];
  float products[kMotions][kMotions];  // centred, lower triangle
};

void compute_moments(const std::int16_t* const* images, const std::int16_t* mask, int m, int count,
                     Moments& s) {
  s.m = m;
  s.mask = mask;
  s.n = dot(mask, mask, count);
  s.inverse_n = 1.0f / static_cast<float>(s.n > 0 ? s.n : 1);
  for (int i = 0; i < m; ++i) s.images[i] = images[i];
  std::int32_t raw[kMotions + 1][kMotions] = {};  // row m: the sums
  for (int i = 0; i < m; ++i) {
    // Four at a time: the images from i on, then the mask, repeated to fill up.
    for (int k = i; k <= m; k += 4) {
      const auto at = [&](int j) { return j < m ? images[j] : mask; };
      const Sums4 d = dot4(images[i], at(k), at(k + 1), at(k + 2), at(k + 3), count);
      const std::int32_t values[4] = {d.a, d.b, d.c, d.d};
      for (int j = 0; j < 4 && k + j <= m; ++j) raw[k + j][i] = values[j];
    }
    s.sums[i] = raw[m][i];
  }
  for (int i = 0; i < m; ++i)
    for (int k = 0; k <= i; ++k)
      s.products[i][k] = centred(s.n, s.inverse_n, raw[i][k], s.sums[i], s.sums[k]);
}

// What is known beforehand: stretches are small (the weight of that), and along an edge there is no shift.
struct Prior {
  float stretch;
  Vec2 along;  // the one direction in which there is a shift; zero: in both
};

// L, unit lower triangular, and d with L diag(d) L' = products + prior. Both this and the substitution take a finished
// unknown out of all others at once: the shorter chain of dependent steps is what their time depends on.
struct Factor {
  float l[kMotions][kMotions];
  float d[kMotions], inverse[kMotions];  // inverse: of d
  bool is_regular;
};

template <int M>
void add_prior(const Prior& prior, float (&a)[kMotions][kMotions]) {
  constexpr int x = M - 2, y = M - 1;
  for (int i = kLight + 1; i < x; ++i) a[i][i] += prior.stretch;
  if (!is_edge(prior.along)) return;
  const float most = a[x][x] + a[y][y];
  a[x][x] += most * prior.along.y * prior.along.y;
  a[y][x] -= most * prior.along.x * prior.along.y;
  a[y][y] += most * prior.along.x * prior.along.x;
}

template <int M>
void factorise(const Moments& s, const Prior& prior, Factor& f) {
  constexpr float kLeast = 1e-4f;  // of the diagonal
  float a[kMotions][kMotions], full[M];
  for (int i = 0; i < M; ++i)
    for (int k = 0; k <= i; ++k) a[i][k] = s.products[i][k];
  add_prior<M>(prior, a);
  for (int i = 0; i < M; ++i) full[i] = a[i][i];
  f.is_regular = false;
  for (int j = 0; j < M; ++j) {
    if (!(a[j][j] > kLeast * full[j])) return;
    f.d[j] = a[j][j];
    f.inverse[j] = 1.0f / a[j][j];
    for (int i = j + 1; i < M; ++i) f.l[i][j] = a[i][j] * f.inverse[j];
    for (int i = j + 1; i < M; ++i)
      for (int k = j + 1; k <= i; ++k) a[i][k] -= f.l[i][j] * a[k][j];
  }
  f.is_regular = true;
}

template <int M>
void substitute(const Factor& f, const float* b, float* x) {
  float v[M];
  for (int i = 0; i < M; ++i) v[i] = b[i];
  for (int j = 0; j < M; ++j)
    for (int i = j + 1; i < M; ++i) v[i] -= f.l[i][j] * v[j];
  for (int i = 0; i < M; ++i) v[i] *= f.inverse[i];
  for (int j = M - 1; j > 0; --j)
    for (int i = 0; i < j; ++i) v[i] -= f.l[j][i] * v[j];
  for (int i = 0; i < M; ++i) x[i] = v[i];
}

// The image's sums with the template's images, and the fit to them.
struct Explained {
  std::int32_t sum;
  float b[kMotions], x[kMotions];
};

// The warp that is left is expected to be `warp`, with this weight.
Explained explain(const Moments& s, const Factor& f, float weight, const Mat2& warp,
                  const std::int16_t* image, int count) {
  Explained e;
  std::int32_t raw[kMotions + 1] = {};
  for (int k = 0; k <= s.m; k += 4) {
    const auto at = [&](int j) { return j < s.m ? s.images[j] : s.mask; };
    const Sums4 d = dot4(image, at(k), at(k + 1), at(k + 2), at(k + 3), count);
    const std::int32_t values[4] = {d.a, d.b, d.c, d.d};
    for (int j = 0; j < 4 && k + j <= s.m; ++j) raw[k + j] = values[j];
  }
  e.sum = raw[s.m];
  for (int i = 0; i < s.m; ++i) e.b[i] = centred(s.n, s.inverse_n, raw[i], s.sums[i], e.sum);
  if (s.m == kWithoutStretch) {
    substitute<kWithoutStretch>(f, e.b, e.x);
    return e;
  }
  const float known[] = {warp.a, warp.b, warp.c, warp.d};
  float b[kMotions];
  for (int i = 0; i < kMotions; ++i) b[i] = e.b[i];
  for (int i = 0; i < 4; ++i) b[kLight + 1 + i] += weight * known[i];
  substitute<kMotions>(f, b, e.x);
  return e;
}

// Share of white noise's variance that cubic sampling at phase f leaves: a fit to the sum of its squared
// weights.
float noise_left(int f) {
  const float t = static_cast<float>(f & (kSubpixel - 1)) / kSubpixel, p = t * (1 - t);
  return 1 - 5.76f * p * p;
}

Measurement measure(const Moments& s, const Factor& f, const Explained& e, GridPosition at,
                    const Work& work) {
  constexpr float kUnit = 1.0f / kGreyScale;
  Measurement r;
  const auto n = static_cast<float>(s.n);
  const float variance_sum =
      centred(s.n, s.inverse_n, sum_squares(work.image, s.mask, work.count), e.sum, e.sum);
  float explained = 0;
  for (int i = 0; i < s.m; ++i) {
    float hx = 0;
    for (int k = 0; k < s.m; ++k) hx += (k <= i ? s.products[i][k] : s.products[k][i]) * e.x[k];
    explained += e.x[i] * (2 * e.b[i] - hx);
  }
  const float left = max(variance_sum - explained, 0);
  r.gain = e.x[kLight];
  r.bias = kUnit * (static_cast<float>(e.sum) / n + kGreyOffset -
                    r.gain * (static_cast<float>(s.sums[kLight]) / n + kGreyOffset));
  const float both = variance_sum * s.products[kLight][kLight];
  r.correlation = both > 0 ? e.b[kLight] / square_root(both) : 0;
  r.pixels = n;
  r.residual_square = kUnit * kUnit * left / n;
  // Sampling between pixels averages noise away in the residual, but not in the sums with the smooth
  // gradient.
  const float smoothing = 2.0f / (1.0f + noise_left(at.x) * noise_left(at.y));
  r.noise_square = kUnit * kUnit * smoothing * left / max(n - static_cast<float>(s.m) - 1, 1);
  // The Schur complement of everything but the shift is made of the last blocks of L and d.
  const int x = s.m - 2, y = s.m - 1;
  const float scale = r.gain * r.gain * kUnit * kUnit;
  const float l = f.l[y][x], d = f.d[x];
  r.information = {scale * d, scale * d * l, scale * (d * l * l + f.d[y])};
  return r;
}

void compute_stretch(Work& work) {
  multiply_by_position(work.plain.gx, work.x, work.y, work.count, work.stretch[0], work.stretch[1]);
  multiply_by_position(work.plain.gy, work.x, work.y, work.count, work.stretch[2], work.stretch[3]);
}

void compute_whole_moments(bool has_stretch, Work& work, Moments& moments) {
  if (!has_stretch) {
    const std::int16_t* const images[] = {work.plain.t, work.plain.gx, work.plain.gy};
    compute_moments(images, work.plain.m, kWithoutStretch, work.count, moments);
    return;
  }
  const std::int16_t* const images[] = {work.plain.t,    work.stretch[0], work.stretch[1], work.stretch[2],
                                        work.stretch[3], work.plain.gx,   work.plain.gy};
  compute_moments(images, work.plain.m, kMotions, work.count, moments);
}

Texture texture_of(const Moments& s) {
  const int x = s.m - 2, y = s.m - 1;
  const float tt = s.products[kLight][kLight], tx = s.products[x][kLight], ty = s.products[y][kLight];
  Texture t{s.n, tt, {}};
  if (!(tt > 0)) return t;
  t.tensor = {s.products[x][x] - tx * tx / tt, s.products[y][x] - tx * ty / tt,
              s.products[y][y] - ty * ty / tt};
  return t;
}

// The moments without what is clipped in the current image.
void compute_moments_without_clipped(const Moments& whole, Work& work, Moments& moments) {
  for (int i = 0; i < whole.m; ++i) apply_mask(whole.images[i], work.unclipped, work.count, work.masked[i]);
  compute_moments(work.masked, work.unclipped, whole.m, work.count, moments);
}

}  // namespace

// The system to be solved while the same pixels count.
struct System {
  Moments moments;
  Factor factor;
  Vec2 along;
  float warp_weight;
  bool is_solvable;

  // From its moments; what a warp is expected to be, and the texture needed.
  void prepare(float warp_sd, const TextureNeeded& needed, int window) {
    is_solvable = false;
    along = {};
    if (!is_usable(texture_of(moments), window, needed, along)) return;
    warp_weight = warp_sd > 0 ? (kPriorNoise / warp_sd) * (kPriorNoise / warp_sd) : 0;
    const Prior prior{warp_weight, along};
    if (moments.m == kMotions)
      factorise<kMotions>(moments, prior, factor);
    else
      factorise<kWithoutStretch>(moments, prior, factor);
    is_solvable = factor.is_regular;
  }
};

System* take_system(Arena& arena) {
  void* const room = arena.take<System>(1);
  return room == nullptr ? nullptr : new (room) System();
}

PatchStatus refine(const ImageView& image, const SearchOptions& o, float warp_sd, Work& work, Position& p,
                   Measurement& result) {
  constexpr int kMaxSteps = 4;
  // What a step leaves is about a tenth of it.
  const float last_move = 10 * o.epsilon_px, most_left = 3 * last_move;
  System &whole = *work.whole, &partial = *work.partial;
  if (warp_sd > 0) compute_stretch(work);
  if (!work.is_prepared) {
    compute_whole_moments(warp_sd > 0, work, whole.moments);
    whole.prepare(warp_sd, o.texture, work.window);
    work.is_prepared = true;
  }
  // In the units of the stretched gradients, which fall short of the slope.
  constexpr float kUnits = 16 / kStepScale;
  const Mat2& left = work.warp_left;
  const Mat2 warp{kUnits * left.a, kUnits * left.b, kUnits * left.c, kUnits * left.d};
  const Vec2 start = p.y;
  for (int step = 1;; ++step) {
    const GridPosition at = on_grid(p.y);
    if (!is_inside(image, at, work.window / 2)) return PatchStatus::outside_image;
    const bool is_cheap = step == 1 && o.starts_cheaply;
    (is_cheap ? sample_linear : sample_cubic)(load_at(image, at, work), at.x & kPhase, at.y & kPhase,
                                              work.window, work.scratch, work.image);
    ++p.iterations;
    const bool is_whole = all_count(o.range, static_cast<int>(whole.moments.n), work);
    if (!is_whole) {
      compute_moments_without_clipped(whole.moments, work, partial.moments);
      partial.prepare(warp_sd, o.texture, work.window);
    }
    const System& now = is_whole ? whole : partial;
    if (!now.is_solvable) return PatchStatus::flat;
    p.along = now.along;
    const Explained e = explain(now.moments, now.factor, now.warp_weight, warp, work.image, work.count);
    const float gain = clamp(e.x[kLight], 0.5f, 2.0f);
    const int m = now.moments.m;
    Vec2 shift{e.x[m - 2], e.x[m - 1]};
    if (is_edge(p.along)) shift = dot(shift, p.along) * p.along;
    const Vec2 moved = position(at) - (kStepScale / gain) * shift;
    const Vec2 move = moved - p.y, way = moved - start;
    p.y = moved;
    if (!(dot(way, way) < 1) || (step == kMaxSteps && dot(move, move) > most_left * most_left))
      return PatchStatus::diverged;
    if (step == kMaxSteps || (!is_cheap && dot(move, move) < last_move * last_move)) {
      result = measure(now.moments, now.factor, e, at, work);
      return PatchStatus::ok;
    }
  }
}

}  // namespace pliant::patch
