#include "vision/patch_result.hpp"

#include "base/symmetric.hpp"
#include "vision/normal_flow.hpp"
#include "vision/patch_tuning.hpp"

namespace pliant {

const char* text(PatchStatus status) {
  switch (status) {
    case PatchStatus::ok:
      return "found";
    case PatchStatus::bad_argument:
      return "bad argument";
    case PatchStatus::empty_slot:
      return "the slot holds no template";
    case PatchStatus::outside_image:
      return "the window leaves the image";
    case PatchStatus::flat:
      return "too little texture";
    case PatchStatus::diverged:
      return "moved too far";
    case PatchStatus::low_correlation:
      return "low correlation with the template";
    case PatchStatus::bad_light:
      return "gain or bias out of range";
    case PatchStatus::inconsistent:
      return "tracking back does not return to the start";
  }
  return "unknown";
}

namespace patch {

namespace {

// (S^-1 noise + floor^2 I)^-1, where S is the information for noise of one: S (noise I + floor^2 S)^-1 needs no
// inverse of S.
Sym2 floored(const Sym2& s, float noise) {
  constexpr float kFloor = kPatchTuning.position_floor_px * kPatchTuning.position_floor_px;
  const Sym2 m{noise + kFloor * s.xx, kFloor * s.xy, noise + kFloor * s.yy};
  const float scale = 1.0f / (m.xx * m.yy - m.xy * m.xy);
  return {scale * (s.xx * m.yy - s.xy * m.xy), scale * (s.xy * m.xx - s.xx * m.xy),
          scale * (s.yy * m.xx - s.xy * m.xy)};
}

}  // namespace

void describe(const Measurement& m, Vec2 along, const NormalFlow* flow, PatchResult& r) {
  r.gain = m.gain;
  r.bias = m.bias;
  r.correlation = m.correlation;
  r.residual = square_root(m.residual_square);
  const float noise = max(m.noise_square, kPatchTuning.noise_floor_grey * kPatchTuning.noise_floor_grey);
  Sym2 s = m.information;
  r.rank = flow != nullptr ? flow->measure(m, along, noise, &s) : 2;
  if (r.rank > 0) r.information = r.rank == 2 ? floored(s, noise) : s;
}

float informed_distance(Vec2 d, const PatchResult& r) {
  const Sym2& s = r.information;
  if (r.rank == 2) return length(d);
  return square_root(quadratic_form(s, d) / (s.xx + s.yy));
}

PatchStatus judge(const PatchResult& r, Vec2 start, const PatchOptions& o) {
  constexpr const PatchTuning& tuning = kPatchTuning;
  if (r.rank == 0) return PatchStatus::flat;
  if (r.correlation < o.min_correlation) return PatchStatus::low_correlation;
  if (r.gain < tuning.min_gain || r.gain > tuning.max_gain || magnitude(r.bias) > tuning.max_bias_grey)
    return PatchStatus::bad_light;
  if (o.max_move_px > 0 && length(r.x - start) > o.max_move_px) return PatchStatus::diverged;
  return PatchStatus::ok;
}

}  // namespace patch

}  // namespace pliant
