// Inverse compositional alignment of a translation, with gain and bias projected out (Baker and Matthews
// 2004; Bartoli 2008 for the projection). With template T, its gradient G, and T' and G' less their means,
// minimise over d, gain and bias: sum (I(y + d) - gain T - bias)^2. Taking out of G what T and a constant
// explain,
//   G* = G' - k T',  k = (G'.T') / (T'.T'),
// leaves a 2 x 2 system:  (G*.G*) d = -(G*.I') / gain.
// Where we depart from the usual form: everything is kept as integer sums over T, G and I, and centred by
// n sum(ab) - sum(a) sum(b) in 64 bits, exactly; neither means nor G* are ever rounded. And the image is
// sampled on a grid of 1/128 px, the rest of the position being part of what the step solves for.
#include "patch_work.hpp"

namespace pliant::patch {
namespace {

// Sum of (a - mean a)(b - mean b) from plain sums; exact before the division.
float centred(std::int64_t n, std::int32_t ab, std::int32_t a, std::int32_t b) {
  return static_cast<float>(n * ab - std::int64_t{a} * b) / static_cast<float>(n);
}

Vec2 solve(const Normal& t, const ImageSums& s) {
  const float ti = centred(t.sums.n, s.ti, t.sums.t, s.i);
  const float bx = centred(t.sums.n, s.xi, t.sums.gx, s.i) - t.light.x * ti;
  const float by = centred(t.sums.n, s.yi, t.sums.gy, s.i) - t.light.y * ti;
  const float gain = clamp(ti / t.variance_sum, 0.5f, 2.0f);
  const float scale = 1.0f / (gain * (t.tensor.xx * t.tensor.yy - t.tensor.xy * t.tensor.xy));
  return {scale * (t.tensor.xy * by - t.tensor.yy * bx), scale * (t.tensor.xy * bx - t.tensor.xx * by)};
}

// A position on the sampling grid.
struct GridPosition {
  int x, y;  // 1/128 px
};
GridPosition on_grid(Vec2 p) {
  constexpr float kShift = 64.0f;  // keeps the conversion, which cuts towards zero, on the positive side
  const auto fixed = [](float v) {
    return static_cast<int>((v + kShift) * kSubpixel + 0.5f) - static_cast<int>(kShift) * kSubpixel;
  };
  return {fixed(p.x), fixed(p.y)};
}
Vec2 position(GridPosition p) {
  return {static_cast<float>(p.x) / kSubpixel, static_cast<float>(p.y) / kSubpixel};
}

// Whether the window (or its centre alone) lies inside the image.
bool is_inside(const ImageView& image, GridPosition p, int radius) {
  const int lo = radius * kSubpixel;
  return p.x >= lo && p.y >= lo && p.x <= (image.width - 1) * kSubpixel - lo &&
         p.y <= (image.height - 1) * kSubpixel - lo;
}

void sample_at(const ImageView& image, GridPosition p, Work& work, Alignment& a) {
  const int w = work.window;
  a.fx = p.x & (kSubpixel - 1);
  a.fy = p.y & (kSubpixel - 1);
  const int left = (p.x - a.fx) / kSubpixel - w / 2, top = (p.y - a.fy) / kSubpixel - w / 2;
  sample(readable(image, left, top, w + 1, lanes(w) + 1, work.bytes), a.fx, a.fy, w, work.image);
}

// Sums the sampled image against the template, without the pixels that are clipped in either. False if too
// few are left.
bool compare(const Normal& whole, const AlignOptions& o, Work& work, Alignment& a) {
  const Template* used = &work.plain;
  a.normal = whole;
  if (o.masks_clipped &&
      has_extremes(work.image, work.plain.m, work.count, o.range.lowest, o.range.highest)) {
    mask_template(work.plain, work.image, work.count, o.range.lowest, o.range.highest, work.masked);
    used = &work.masked;
    a.normal = normal_of(sum_template(*used, work.count));
    if (!is_usable(a.normal, work.window, o.min_eigenvalue)) return false;
  }
  a.mask = used->m;
  a.image = sum_image(*used, work.image, work.count);
  return true;
}

}  // namespace

Normal normal_of(const TemplateSums& s) {
  Normal t;
  t.sums = s;
  if (s.n == 0) return t;
  t.n = static_cast<float>(s.n);
  t.mean = static_cast<float>(s.t) / t.n;
  t.variance_sum = centred(s.n, s.tt, s.t, s.t);
  if (!(t.variance_sum > 0)) return t;
  const Vec2 tg{centred(s.n, s.tx, s.t, s.gx), centred(s.n, s.ty, s.t, s.gy)};
  t.light = (1.0f / t.variance_sum) * tg;
  t.tensor.xx = centred(s.n, s.xx, s.gx, s.gx) - t.light.x * tg.x;
  t.tensor.xy = centred(s.n, s.xy, s.gx, s.gy) - t.light.x * tg.y;
  t.tensor.yy = centred(s.n, s.yy, s.gy, s.gy) - t.light.y * tg.y;
  return t;
}

bool is_usable(const Normal& t, int window, float min_eigenvalue) {
  constexpr float kScale = kGreyScale * kGreyScale;
  constexpr float kMinVariance = 4.0f * kScale;  // grey^2
  if (2 * t.sums.n < window * window || t.variance_sum < kMinVariance * t.n) return false;
  constexpr float kMinRatio = 1e-4f;  // of the eigenvalues; below it the system is singular in float
  const float half_sum = 0.5f * (t.tensor.xx + t.tensor.yy),
              half_difference = 0.5f * (t.tensor.xx - t.tensor.yy);
  const float root = square_root(half_difference * half_difference + t.tensor.xy * t.tensor.xy);
  const float smallest = half_sum - root;
  return smallest > kMinRatio * (half_sum + root) && smallest >= min_eigenvalue * kScale * t.n;
}

PatchStatus align(const ImageView& image, const AlignOptions& o, Work& work, Alignment& a) {
  const Normal whole = normal_of(sum_template(work.plain, work.count));
  if (!is_usable(whole, work.window, o.min_eigenvalue)) return PatchStatus::flat;
  const Vec2 start = a.y;
  const auto reach = static_cast<float>(work.window / 2 + 1);
  Vec2 previous_move;
  for (a.iterations = 1;; ++a.iterations) {
    const GridPosition p = on_grid(a.y);
    if (!is_inside(image, p, o.needs_whole_window ? work.window / 2 : 0)) return PatchStatus::outside_image;
    sample_at(image, p, work, a);
    if (!compare(whole, o, work, a)) return PatchStatus::flat;
    const Vec2 step = solve(a.normal, a.image);
    const Vec2 limited{clamp(step.x, -reach, reach), clamp(step.y, -reach, reach)};
    const Vec2 move = position(p) + limited - a.y;
    a.y = a.y + move;
    if (magnitude(a.y.x - start.x) > reach || magnitude(a.y.y - start.y) > reach)
      return PatchStatus::diverged;
    const Vec2 turn = move + previous_move;
    const bool oscillates = magnitude(turn.x) < o.epsilon_px && magnitude(turn.y) < o.epsilon_px;
    if (oscillates) a.y = a.y - 0.5f * move;
    if (oscillates || dot(move, move) < o.epsilon_px * o.epsilon_px || a.iterations >= o.max_iterations)
      return PatchStatus::ok;
    previous_move = move;
  }
}

}  // namespace pliant::patch
