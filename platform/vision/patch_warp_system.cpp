#include "vision/patch_warp_system.hpp"

#include <type_traits>

#include "vision/halfwords.hpp"
#include "vision/patch_sums.hpp"
#include "vision/patch_texture.hpp"

namespace pliant::patch {
namespace {

// Loops over unknowns, [from, to). With vectors they are unrolled, so that small arrays stay in registers: of such loops GCC
// makes short vectors, which wait for the elements that were stored before. Elsewhere they are loops, which are shorter.
#if PLIANT_HAS_HALFWORDS

using Unknown = int;
constexpr Unknown kEnd = kUnknowns;

constexpr Unknown after(Unknown i) {
  return i + 1;
}
constexpr Unknown mirrored(Unknown i, Unknown first) {
  return kUnknowns - 1 + first - i;
}
template <class F>
inline void for_each(Unknown from, Unknown to, F f) {
  for (Unknown i = from; i < to; ++i) f(i);
}
template <class F>
inline auto with_first(int first, F f) {
  return f(first);
}

#else

template <int i>
using Unknown = std::integral_constant<int, i>;
constexpr Unknown<kUnknowns> kEnd;

template <int i>
constexpr Unknown<i + 1> after(Unknown<i>) {
  return {};
}
template <int i, int first>
constexpr Unknown<kUnknowns - 1 + first - i> mirrored(Unknown<i>, Unknown<first>) {
  return {};
}
template <int from, int to, class F>
inline void for_each(Unknown<from> i, Unknown<to> end, F f) {
  if constexpr (from < to) {
    f(i);
    for_each(after(i), end, f);
  }
}
template <class F>
inline auto with_first(int first, F f) {
  return first == kRamp ? f(Unknown<kRamp>{}) : f(Unknown<kLight>{});
}

#endif

constexpr int kShiftX = kShift, kShiftY = kShift + 1;

// Weight of a prior: unknowns are as small as this deviation.
constexpr float weight_of(float sd) {
  return (kPatchTuning.prior_noise_grey / sd) * (kPatchTuning.prior_noise_grey / sd);
}
constexpr float kWarpWeight = weight_of(kPatchTuning.warp_sd);

// Products of v with the images from `from` on; the last one is its sum.
void multiply(const WarpSystem& s, const i16* v, int from, int count, i32 (&products)[kUnknowns + 1]) {
  // Four at a time; the mask fills up the last four.
  const auto at = [&](int i) { return s.images[i < kUnknowns ? i : kUnknowns]; };
  for (int i = from; i <= kUnknowns; i += 4) {
    const Sums4 four = dot4(v, at(i), at(i + 1), at(i + 2), at(i + 3), count);
    const i32 values[4] = {four.a, four.b, four.c, four.d};
    for (int j = 0; j < 4 && i + j <= kUnknowns; ++j) products[i + j] = values[j];
  }
}

#if !PLIANT_HAS_HALFWORDS

// Products of the eight images from light on in blocks of four: those of a block with itself need each image once.
void multiply_blocks(const i16* const* images, int count, i32 (&raw)[kUnknowns][kUnknowns + 1]) {
  static_assert(kUnknowns + 1 - kLight == 8, "");
  constexpr int kMiddle = kLight + 4;
  for (int k = kLight; k <= kMiddle; k += 4) {
    const Sums10 p = products_of(images[k], images[k + 1], images[k + 2], images[k + 3], count);
    const i32 rows[4][4] = {
        {p.aa, p.ab, p.ac, p.ad}, {0, p.bb, p.bc, p.bd}, {0, 0, p.cc, p.cd}, {0, 0, 0, p.dd}};
    for (int i = 0; i < 4 && k + i < kUnknowns; ++i)
      for (int j = i; j < 4; ++j) raw[k + i][k + j] = rows[i][j];
  }
  for (int k = kLight; k < kMiddle; ++k) {
    const Sums4 p = dot4(images[k], images[kMiddle], images[kMiddle + 1], images[kMiddle + 2],
                         images[kMiddle + 3], count);
    const i32 row[4] = {p.a, p.b, p.c, p.d};
    for (int j = 0; j < 4; ++j) raw[k][kMiddle + j] = row[j];
  }
}

#endif

void compute_products(int count, WarpSystem& s) {
  const i16* const mask = s.images[kUnknowns];
  s.n = dot(mask, mask, count);
  s.inverse_n = 1.0f / static_cast<float>(s.n > 0 ? s.n : 1);
  i32 raw[kUnknowns][kUnknowns + 1];  // raw[k][i], k <= i
#if !PLIANT_HAS_HALFWORDS
  multiply_blocks(s.images, count, raw);
#endif
  for (int k = s.first; k < kUnknowns; ++k) {
    if (PLIANT_HAS_HALFWORDS || k < kLight) multiply(s, s.images[k], k, count, raw[k]);
    s.sums[k] = raw[k][kUnknowns];
  }
  for (int i = s.first; i < kUnknowns; ++i)
    for (int k = s.first; k <= i; ++k)
      s.products[lower(i, k)] = centred(s.n, s.inverse_n, raw[k][i], s.sums[i], s.sums[k]);
}

// Light projected out of the gradients.
Texture texture_of(const WarpSystem& s) {
  const auto p = [&s](int i, int k) { return s.products[lower(i, k)]; };
  const float tt = p(kLight, kLight), tx = p(kShiftX, kLight), ty = p(kShiftY, kLight);
  Texture t{s.n, tt, {}};
  if (!(tt > 0)) return t;
  t.tensor = {p(kShiftX, kShiftX) - tx * tx / tt, p(kShiftY, kShiftX) - tx * ty / tt,
              p(kShiftY, kShiftY) - ty * ty / tt};
  return t;
}

void add_priors(float ramp_sd, Vec2 along, float (&a)[kUnknowns][kUnknowns]) {
  if (ramp_sd > 0)
    for (int i = kRamp; i < kLight; ++i) a[i][i] += weight_of(ramp_sd);
  for (int i = kStretch; i < kShift; ++i) a[i][i] += kWarpWeight;
  if (!is_edge(along)) return;
  Sym2 shift{a[kShiftX][kShiftX], a[kShiftY][kShiftX], a[kShiftY][kShiftY]};
  confine(shift, along, shift.xx + shift.yy);
  a[kShiftX][kShiftX] = shift.xx;
  a[kShiftY][kShiftX] = shift.xy;
  a[kShiftY][kShiftY] = shift.yy;
}

// Here and in the substitution a finished unknown is eliminated from all others at once. This gives the shortest chain of
// dependent operations, which determines the time.
template <class First>
bool factorise(First first, float ramp_sd, WarpSystem& s) {
  float a[kUnknowns][kUnknowns], diagonal[kUnknowns];
  for (int i = first; i < kUnknowns; ++i)
    for (int k = first; k <= i; ++k) a[i][k] = s.products[lower(i, k)];
  add_priors(ramp_sd, s.along, a);
  for (int i = first; i < kUnknowns; ++i) diagonal[i] = a[i][i];
  bool is_regular = true;
  for_each(first, kEnd, [&](auto j) {
    is_regular = is_regular && a[j][j] > kPatchTuning.min_pivot_ratio * diagonal[j];
    s.d[j] = a[j][j];
    s.inverse_d[j] = 1.0f / a[j][j];
    for_each(after(j), kEnd, [&](auto i) { s.l[lower(i, j)] = a[i][j] * s.inverse_d[j]; });
    for_each(after(j), kEnd, [&](auto i) {
      for_each(after(j), after(i), [&](auto k) { a[i][k] -= s.l[lower(i, j)] * a[k][j]; });
    });
  });
  return is_regular;
}

template <class First>
void substitute(First first, const WarpSystem& s, float (&x)[kUnknowns]) {
  float v[kUnknowns];
  for_each(first, kEnd, [&](auto i) { v[i] = x[i]; });
  for_each(first, kEnd,
           [&](auto j) { for_each(after(j), kEnd, [&](auto i) { v[i] -= s.l[lower(i, j)] * v[j]; }); });
  for_each(first, kEnd, [&](auto i) { v[i] *= s.inverse_d[i]; });
  for_each(first, kEnd, [&](auto k) {
    const auto j = mirrored(k, first);
    for_each(first, j, [&](auto i) { v[i] -= s.l[lower(j, i)] * v[j]; });
  });
  for_each(first, kEnd, [&](auto i) { x[i] = v[i]; });
}

}  // namespace

void prepare(const i16* const* images, int window, float ramp_sd, bool accepts_edges, WarpSystem& s) {
  s.first = ramp_sd > 0 ? kRamp : kLight;
  for (int i = s.first; i <= kUnknowns; ++i) s.images[i] = images[i];
  compute_products(padded(window), s);
  s.is_solvable = is_usable(texture_of(s), window, accepts_edges, s.along) &&
                  with_first(s.first, [&](auto first) { return factorise(first, ramp_sd, s); });
}

WarpFit fit(const WarpSystem& s, const Mat2& expected, const i16* image, int count) {
  PLIANT_ASSERT(s.is_solvable);
  WarpFit r;
  i32 raw[kUnknowns + 1];
  multiply(s, image, s.first, count, raw);
  r.sum = raw[kUnknowns];
  for (int i = s.first; i < kUnknowns; ++i)
    r.x[i] = r.b[i] = centred(s.n, s.inverse_n, raw[i], s.sums[i], r.sum);
  const float stretch[] = {expected.a, expected.b, expected.c, expected.d};
  for (int i = 0; i < 4; ++i) r.x[kStretch + i] += kWarpWeight * stretch[i];
  with_first(s.first, [&](auto first) { substitute(first, s, r.x); });
  return r;
}

float unexplained(const WarpSystem& s, const WarpFit& fit, float variance_sum) {
  float explained = 0;
  with_first(s.first, [&](auto first) {
    for_each(first, kEnd, [&](auto i) {
      float hx = 0;
      for_each(first, kEnd, [&](auto k) { hx += s.products[k <= i ? lower(i, k) : lower(k, i)] * fit.x[k]; });
      explained += fit.x[i] * (2 * fit.b[i] - hx);
    });
  });
  return max(variance_sum - explained, 0);
}

Sym2 shift_information(const WarpSystem& s, float scale) {
  // Made of the last blocks of L and d, because the shift comes last.
  const float l = s.l[lower(kShiftY, kShiftX)], d = s.d[kShiftX];
  return {scale * d, scale * d * l, scale * (d * l * l + s.d[kShiftY])};
}

}  // namespace pliant::patch
