#include "vision/patch_result.hpp"

#include "vision/patch_tuning.hpp"
#include "vision/structure_tensor.hpp"

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

// The fraction of white noise's variance in Scharr gradients: 2 (3^2 + 10^2 + 3^2) / 32^2.
constexpr float kScharrNoise = 0.23f;

// (S^-1 noise + floor^2 I)^-1, where S is the information for noise of one: S (noise I + floor^2 S)^-1 needs no
// inverse of S.
Sym2 floored(const Sym2& s, float noise) {
  constexpr float kFloor = kPatchTuning.position_floor_px * kPatchTuning.position_floor_px;
  const Sym2 m{noise + kFloor * s.xx, kFloor * s.xy, noise + kFloor * s.yy};
  const float scale = 1.0f / (m.xx * m.yy - m.xy * m.xy);
  return {scale * (s.xx * m.yy - s.xy * m.xy), scale * (s.xy * m.xx - s.xx * m.xy),
          scale * (s.yy * m.xx - s.xy * m.xy)};
}

// The same in one direction, of a part v of the information: (v^-1 noise + floor^2)^-1.
Sym2 floored_along(float v, Vec2 n, float noise) {
  constexpr float kFloorPx = kPatchTuning.position_floor_px;
  const float w = v / (noise + kFloorPx * kFloorPx * v);
  return {w * n.x * n.x, w * n.x * n.y, w * n.y * n.y};
}

// The rank of the information, where edges are accepted. Part of the gradients is noise of the template, which
// carries no information about the position: it is taken off `information`. Sets `along` for an edge.
int rank_of(const Measurement& m, Sym2& information, Vec2& along) {
  // Half of the noise is the template's.
  const float noise_part = kScharrNoise * 0.5f * m.noise_square * m.pixels;
  const float least = kPatchTuning.min_gradient_to_noise * noise_part;
  const Eigenvalues e = eigenvalues(m.information);
  if (e.largest < least) return 0;
  information = {m.information.xx - noise_part, m.information.xy, m.information.yy - noise_part};
  if (is_edge(along)) return 1;
  if (e.smallest >= least && e.smallest > kPatchTuning.edge_eigenvalue_ratio * e.largest) return 2;
  along = strongest_direction(m.information, e.smallest);
  return 1;
}

}  // namespace

void describe(const Measurement& m, Vec2 along, bool accepts_edges, PatchResult& r) {
  r.gain = m.gain;
  r.bias = m.bias;
  r.correlation = m.correlation;
  r.residual = square_root(m.residual_square);
  const float noise = max(m.noise_square, kPatchTuning.noise_floor_grey * kPatchTuning.noise_floor_grey);
  Sym2 s = m.information;
  r.rank = accepts_edges ? rank_of(m, s, along) : 2;
  if (r.rank == 2) r.information = floored(s, noise);
  if (r.rank != 1) return;
  const float v = s.xx * along.x * along.x + 2 * s.xy * along.x * along.y + s.yy * along.y * along.y;
  // Of a search that an edge has confined only this counts: the largest eigenvalue is of what is added along the edge (confine).
  const float noise_part = m.information.xx - s.xx;
  if (v < (kPatchTuning.min_gradient_to_noise - 1) * noise_part)
    r.rank = 0;
  else
    r.information = floored_along(v, along, noise);
}

float informed_distance(Vec2 d, const PatchResult& r) {
  const Sym2& s = r.information;
  if (r.rank == 2) return length(d);
  return square_root((s.xx * d.x * d.x + 2 * s.xy * d.x * d.y + s.yy * d.y * d.y) / (s.xx + s.yy));
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
