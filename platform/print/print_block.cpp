#include "print/print_block.hpp"

#include <cmath>

namespace pliant {

bool make_block(const SurfacePlace& place, Block* block) {
  const Vec2 a{place.px_per_uv.a, place.px_per_uv.c}, b{place.px_per_uv.b, place.px_per_uv.d};
  const float longer = dot(a, a) > dot(b, b) ? dot(a, a) : dot(b, b);
  if (!(determinant(place.px_per_uv) > max(kBlockTuning.least_slant * longer, kBlockTuning.least_area_px2)))
    return false;
  *block = {place.uv, place.x, inverse(place.px_per_uv), {}, {}};
  return true;
}

bool find_block(const SurfaceProjection& project, Vec2 uv, Block* block) {
  const float du = uv.x > 0.5f ? -kBlockTuning.step_uv : kBlockTuning.step_uv,
              dv = uv.y > 0.5f ? -kBlockTuning.step_uv : kBlockTuning.step_uv;
  Vec2 x, along_u, along_v;
  if (!project(uv, &x) || !project(uv + Vec2{du, 0}, &along_u) || !project(uv + Vec2{0, dv}, &along_v))
    return false;
  const Vec2 a = (1 / du) * (along_u - x), b = (1 / dv) * (along_v - x);
  return make_block({uv, x, {a.x, b.x, a.y, b.y}}, block);
}

float correlate(const float* grey, int stride, const ExpectedBlock& expected) {
  const Lanes first_three{1, 1, 1, 0};
  Lanes x = splat(0), xx = x, xy = x;
  for (int j = 0; j < kBlockSide; ++j) {
    const float *const row = grey + j * stride, *const albedo = expected.samples + j * ExpectedBlock::kRow;
    const Lanes a = load(row), b = load(row + kLanes) * first_three;
    x += a + b;
    xx += a * a + b * b;
    xy += a * load(albedo) + b * load(albedo + kLanes);
  }
  constexpr float kPart = 1.0f / kBlockSamples;
  const float mean = kPart * sum(x), variance = kPart * sum(xx) - mean * mean;
  if (!(variance >= kBlockTuning.least_sd * kBlockTuning.least_sd)) return 0;
  return kPart * sum(xy) / std::sqrt(variance * expected.variance);
}

}  // namespace pliant
