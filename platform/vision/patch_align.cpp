// Inverse compositional alignment of a translation, with gain and bias projected out (Baker and Matthews
// 2004; Bartoli 2008 for the projection). With template T, its gradient G, and T' and G' less their means,
// minimise over d, gain and bias: sum (I(y + d) - gain T - bias)^2. Taking out of G what T and a constant
// explain,
//   G* = G' - k T',  k = (G'.T') / (T'.T'),
// leaves a 2 x 2 system:  (G*.G*) d = -(G*.I') / gain.
// Where we depart from the usual form: everything is kept as integer sums over T, G and I, and centred by
// n sum(ab) - sum(a) sum(b) in 64 bits, exactly; neither means nor G* are ever rounded. And the image is
// sampled on a grid of 1/128 px, the rest of the position being part of what the step solves for.
#include "vision/patch_work.hpp"
#include "vision/tensor.hpp"

namespace pliant::patch {
namespace {

// What is constant while the same pixels count: the template's moments, light projected out.
struct Normal {
  Template arrays;
  std::int64_t n;
  float inverse_n;
  std::int32_t t, gx, gy;  // sums
  float variance_sum;
  Vec2 light;   // of each gradient image, the multiple of the template that is taken out
  Sym2 tensor;  // sum of products of the gradient images, light taken out
  Vec2 along;   // the only direction in which there is texture; zero: there is in both
};

Normal normal_of(const Template& a, int count) {
  const Sums4 m = dot4(a.m, a.m, a.t, a.gx, a.gy, count), t = dot4(a.t, a.t, a.gx, a.gy, a.m, count);
  const Sums4 g = dot4(a.gx, a.gx, a.gy, a.m, a.m, count);
  Normal s{a, m.a, 1.0f / static_cast<float>(m.a > 0 ? m.a : 1), m.b, m.c, m.d, 0, {}, {}, {}};
  s.variance_sum = centred(s.n, s.inverse_n, t.a, s.t, s.t);
  if (!(s.variance_sum > 0)) return s;
  const Vec2 tg{centred(s.n, s.inverse_n, t.b, s.t, s.gx), centred(s.n, s.inverse_n, t.c, s.t, s.gy)};
  s.light = (1.0f / s.variance_sum) * tg;
  s.tensor.xx = centred(s.n, s.inverse_n, g.a, s.gx, s.gx) - s.light.x * tg.x;
  s.tensor.xy = centred(s.n, s.inverse_n, g.b, s.gx, s.gy) - s.light.x * tg.y;
  s.tensor.yy = centred(s.n, s.inverse_n, dot(a.gy, a.gy, count), s.gy, s.gy) - s.light.y * tg.y;
  return s;
}

// The same for a search along an edge: as if there were as much texture across it, which gives no step there.
void confine(Normal& s) {
  if (!is_edge(s.along)) return;
  const float largest = s.tensor.xx * s.along.x * s.along.x + 2 * s.tensor.xy * s.along.x * s.along.y +
                        s.tensor.yy * s.along.y * s.along.y;
  s.tensor.xx += largest * s.along.y * s.along.y;
  s.tensor.xy -= largest * s.along.x * s.along.y;
  s.tensor.yy += largest * s.along.x * s.along.x;
}

bool is_usable(Normal& s, int window, const TextureNeeded& needed) {
  if (!is_usable({s.n, s.variance_sum, s.tensor}, window, needed, s.along)) return false;
  confine(s);
  return true;
}

// The step from where `image` was sampled.
Vec2 solve(const Normal& s, const std::int16_t* image, int count) {
  const Sums4 i = dot4(image, s.arrays.m, s.arrays.t, s.arrays.gx, s.arrays.gy, count);
  const float ti = centred(s.n, s.inverse_n, i.b, s.t, i.a);
  Vec2 b{centred(s.n, s.inverse_n, i.c, s.gx, i.a) - s.light.x * ti,
         centred(s.n, s.inverse_n, i.d, s.gy, i.a) - s.light.y * ti};
  if (is_edge(s.along)) b = dot(b, s.along) * s.along;
  const float gain = clamp(ti / s.variance_sum, 0.5f, 2.0f);
  const float scale = 1.0f / (gain * (s.tensor.xx * s.tensor.yy - s.tensor.xy * s.tensor.xy));
  return {scale * (s.tensor.xy * b.y - s.tensor.yy * b.x), scale * (s.tensor.xy * b.x - s.tensor.xx * b.y)};
}

// The template without the pixels that are clipped in the image.
Normal normal_without_clipped(Work& work) {
  const Template out{work.masked[kLight], work.masked[kShift], work.masked[kShift + 1], work.unclipped};
  apply_mask(work.plain.t, out.m, work.count, out.t);
  apply_mask(work.plain.gx, out.m, work.count, out.gx);
  apply_mask(work.plain.gy, out.m, work.count, out.gy);
  return normal_of(out, work.count);
}

}  // namespace

bool is_usable(const Texture& t, int window, const TextureNeeded& needed, Vec2& along) {
  constexpr float kScale = kGreyScale * kGreyScale;
  constexpr float kMinVariance = 4.0f * kScale;  // grey^2
  // Of the eigenvalues: below it the system is singular in float, or the patch an edge.
  const float min_ratio = needed.edge_will_do ? kEdgeRatio : 1e-4f;
  const auto pixels = static_cast<float>(t.pixels);
  along = {};
  if (2 * t.pixels < window * window || t.variance_sum < kMinVariance * pixels) return false;
  const float least = needed.min_eigenvalue * kScale * pixels;
  const Eigenvalues e = eigenvalues(t.tensor);
  if (e.smallest > min_ratio * e.largest && e.smallest >= least) return true;
  if (!needed.edge_will_do || !(e.largest > 0) || e.largest < least) return false;
  along = strongest_direction(t.tensor, e.smallest);
  return true;
}

bool has_texture(const Work& work, const TextureNeeded& needed) {
  Normal s = normal_of(work.plain, work.count);
  return is_usable(s, work.window, needed);
}

GridPosition on_grid(Vec2 p) {
  constexpr int kMargin = 64;  // px; keeps the conversion, which cuts towards zero, on the positive side
  const auto fixed = [](float v) {
    return static_cast<int>((v + kMargin) * kSubpixel + 0.5f) - kMargin * kSubpixel;
  };
  return {fixed(p.x), fixed(p.y)};
}

const std::int16_t* load_at(const ImageView& image, GridPosition p, Work& work) {
  const int w = work.window, fx = p.x & kPhase, fy = p.y & kPhase;
  const int left = (p.x - fx) / kSubpixel - w / 2, top = (p.y - fy) / kSubpixel - w / 2;
  load_block(image, left - 1, top - 1, work);
  return work.block;
}

bool all_count(GreyRange range, int pixels, Work& work) {
  if (is_within(work.image, work.count, range.lowest, range.highest)) return true;
  return mask_extremes(work.image, work.plain.m, work.count, range.lowest, range.highest, work.unclipped) ==
         pixels;
}

bool is_inside(const ImageView& image, GridPosition p, int radius) {
  const int lo = radius * kSubpixel;
  return p.x >= lo && p.y >= lo && p.x <= (image.width - 1) * kSubpixel - lo &&
         p.y <= (image.height - 1) * kSubpixel - lo;
}

PatchStatus align(const ImageView& image, const SearchOptions& o, Work& work, Position& p) {
  Normal whole = normal_of(work.plain, work.count);
  if (!is_usable(whole, work.window, o.texture)) return PatchStatus::flat;
  p.along = whole.along;
  const Vec2 start = p.y;
  const auto reach = static_cast<float>(work.window);
  Vec2 previous_move;
  for (p.iterations = 1;; ++p.iterations) {
    const GridPosition at = on_grid(p.y);
    if (!is_inside(image, at, o.needs_whole_window ? work.window / 2 : 0)) return PatchStatus::outside_image;
    sample_linear(load_at(image, at, work), at.x & kPhase, at.y & kPhase, work.window, work.scratch,
                  work.image);
    Normal now = whole;
    if (!all_count(o.range, static_cast<int>(whole.n), work)) {
      now = normal_without_clipped(work);
      if (!is_usable(now, work.window, o.texture)) return PatchStatus::flat;
    }
    const Vec2 step = kStepScale * solve(now, work.image, work.count);
    const Vec2 limited{clamp(step.x, -reach, reach), clamp(step.y, -reach, reach)};
    const Vec2 move = position(at) + limited - p.y;
    p.y = p.y + move;
    if (magnitude(p.y.x - start.x) > reach || magnitude(p.y.y - start.y) > reach)
      return PatchStatus::diverged;
    const Vec2 turn = move + previous_move;
    const bool oscillates = magnitude(turn.x) < o.epsilon_px && magnitude(turn.y) < o.epsilon_px;
    if (oscillates) p.y = p.y - 0.5f * move;
    if (oscillates || dot(move, move) < o.epsilon_px * o.epsilon_px || p.iterations >= o.max_iterations)
      return PatchStatus::ok;
    previous_move = move;
  }
}

}  // namespace pliant::patch
