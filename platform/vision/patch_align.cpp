// Inverse compositional alignment of a translation with gain and bias projected out (Baker and Matthews 2004; Bartoli
// 2008 for the projection; docs/algorithms.md, section 7.2). With template T, its gradient G, and T' and G' less
// their means, minimise over d, gain and bias: sum (I(y + d) - gain T - bias)^2. Without what T and a constant
// explain, G is
//   G* = G' - k T',  k = (G'.T') / (T'.T'),
// and the 2 x 2 system is  (G*.G*) d = -(G*.I') / gain. Departures from the usual form: everything is kept as integer
// sums over T, G and I and centred by n sum(ab) - sum(a) sum(b) in 64 bits, exactly, so that neither means nor G* are
// rounded. The image is sampled on a grid of 1/128 px; the remainder of the position is part of the solved step.
#include "vision/patch_align.hpp"

#include "base/symmetric.hpp"
#include "vision/patch_sums.hpp"
#include "vision/patch_window.hpp"

namespace pliant::patch {
namespace {

// The left-hand side: constant while the same pixels count.
struct TranslationSystem {
  Template images;
  i32 n;  // pixels
  float inverse_n;
  i32 t, gx, gy;  // sums
  float variance_sum;
  Vec2 light;   // multiple of the template that is taken out of each gradient image
  Sym2 tensor;  // sums of products of the gradient images without light
  Vec2 along;   // the only direction of texture; zero: both
};

TranslationSystem system_of(const Template& a, int count) {
  const Sums10 p = products_of(a.m, a.t, a.gx, a.gy, count);
  TranslationSystem s{a,  p.aa, 1.0f / static_cast<float>(p.aa > 0 ? p.aa : 1), p.ab, p.ac, p.ad, 0, {},
                      {}, {}};
  s.variance_sum = centred(s.n, s.inverse_n, p.bb, s.t, s.t);
  if (!(s.variance_sum > 0)) return s;
  const Vec2 tg{centred(s.n, s.inverse_n, p.bc, s.t, s.gx), centred(s.n, s.inverse_n, p.bd, s.t, s.gy)};
  s.light = (1.0f / s.variance_sum) * tg;
  s.tensor.xx = centred(s.n, s.inverse_n, p.cc, s.gx, s.gx) - s.light.x * tg.x;
  s.tensor.xy = centred(s.n, s.inverse_n, p.cd, s.gx, s.gy) - s.light.x * tg.y;
  s.tensor.yy = centred(s.n, s.inverse_n, p.dd, s.gy, s.gy) - s.light.y * tg.y;
  return s;
}

bool make_solvable(TranslationSystem& s, int window, bool accepts_edges) {
  if (!is_usable({s.n, s.variance_sum, s.tensor}, window, accepts_edges, s.along)) return false;
  if (is_edge(s.along)) confine(s.tensor, s.along, quadratic_form(s.tensor, s.along));
  return true;
}

// The step from where `image` was sampled.
Vec2 solve(const TranslationSystem& s, const i16* image, int count) {
  const Sums4 i = dot4(image, s.images.m, s.images.t, s.images.gx, s.images.gy, count);
  const float ti = centred(s.n, s.inverse_n, i.b, s.t, i.a);
  Vec2 b{centred(s.n, s.inverse_n, i.c, s.gx, i.a) - s.light.x * ti,
         centred(s.n, s.inverse_n, i.d, s.gy, i.a) - s.light.y * ti};
  if (is_edge(s.along)) b = dot(b, s.along) * s.along;
  const float gain = clamp(ti / s.variance_sum, kPatchTuning.least_step_gain, kPatchTuning.max_gain);
  const float scale = 1.0f / (gain * (s.tensor.xx * s.tensor.yy - s.tensor.xy * s.tensor.xy));
  return {scale * (s.tensor.xy * b.y - s.tensor.yy * b.x), scale * (s.tensor.xy * b.x - s.tensor.xx * b.y)};
}

// The system without the pixels that are clipped in the image.
TranslationSystem unclipped_system(Workspace& work) {
  const Template out{work.masked[kLight], work.masked[kShift], work.masked[kShift + 1], work.unclipped};
  apply_mask(work.active.t, out.m, work.count, out.t);
  apply_mask(work.active.gx, out.m, work.count, out.gx);
  apply_mask(work.active.gy, out.m, work.count, out.gy);
  return system_of(out, work.count);
}

}  // namespace

bool has_texture(const Workspace& work, bool accepts_edges) {
  TranslationSystem s = system_of(work.active, work.count);
  return make_solvable(s, work.window, accepts_edges);
}

PatchStatus align(const ImageView& image, const SearchOptions& o, Workspace& work, SearchPosition& p) {
  constexpr float kStop = kPatchTuning.align_stop_ratio * kPatchTuning.epsilon_px;
  TranslationSystem whole = system_of(work.active, work.count), unclipped;
  if (!make_solvable(whole, work.window, o.accepts_edges)) return PatchStatus::flat;
  p.along = whole.along;
  const Vec2 start = p.x;
  const auto reach = static_cast<float>(work.window);
  const int margin = o.needs_whole_window ? work.window / 2 : 0;
  Vec2 previous_move;
  for (p.iterations = 1;; ++p.iterations) {
    const GridPosition at = on_grid(p.x);
    if (!is_inside(image, at, margin)) return PatchStatus::outside_image;
    sample_window(image, at, Sampling::linear, work);
    const bool is_whole = is_all_unclipped(whole.n, work);
    if (!is_whole) {
      unclipped = unclipped_system(work);
      if (!make_solvable(unclipped, work.window, o.accepts_edges)) return PatchStatus::flat;
    }
    const Vec2 step = kPatchTuning.step_scale * solve(is_whole ? whole : unclipped, work.image, work.count);
    const Vec2 limited{clamp(step.x, -reach, reach), clamp(step.y, -reach, reach)};
    const Vec2 move = position(at) + limited - p.x;
    p.x = p.x + move;
    if (magnitude(p.x.x - start.x) > reach || magnitude(p.x.y - start.y) > reach)
      return PatchStatus::diverged;
    const Vec2 turn = move + previous_move;
    const bool oscillates = magnitude(turn.x) < kStop && magnitude(turn.y) < kStop;
    if (oscillates) p.x = p.x - 0.5f * move;
    if (oscillates || dot(move, move) < kStop * kStop || p.iterations >= kPatchTuning.max_align_steps)
      return PatchStatus::ok;
    previous_move = move;
  }
}

}  // namespace pliant::patch
