// How sure a measured place is, and whether it is the one that was looked for.
#include "vision/patch_result.hpp"

#include "vision/tensor.hpp"

namespace pliant {

const char* text(PatchStatus status) {
  switch (status) {
    case PatchStatus::ok:
      return "found";
    case PatchStatus::bad_argument:
      return "bad argument";
    case PatchStatus::empty_slot:
      return "nothing was captured in this slot";
    case PatchStatus::outside_image:
      return "the window leaves the picture";
    case PatchStatus::flat:
      return "too little texture";
    case PatchStatus::diverged:
      return "moved too far";
    case PatchStatus::low_correlation:
      return "does not look like the template";
    case PatchStatus::bad_light:
      return "gain or bias out of range";
    case PatchStatus::inconsistent:
      return "does not return when tracked back";
  }
  return "unknown";
}

namespace patch {

namespace {

// (S^-1 noise + floor^2 I)^-1, of which S = information for a noise of one: S (noise I + floor^2 S)^-1, which
// needs no inverse of S.
Sym2 floored(const Sym2& s, float noise, float floor_px) {
  const float f = floor_px * floor_px;
  const Sym2 m{noise + f * s.xx, f * s.xy, noise + f * s.yy};
  const float scale = 1.0f / (m.xx * m.yy - m.xy * m.xy);
  return {scale * (s.xx * m.yy - s.xy * m.xy), scale * (s.xy * m.xx - s.xx * m.xy),
          scale * (s.yy * m.xx - s.xy * m.xy)};
}

// The rank of what was measured, its information for a noise of one, and where it is an edge its direction. Part of the
// gradients is noise of the template, of which Scharr's operator leaves 0.23; it says nothing about where the image is.
int rank_of(const Measurement& m, Sym2& information, Vec2& along) {
  constexpr float kGradientNoise = 0.23f, kLeast = 2;
  const float false_part =
      kGradientNoise * 0.5f * m.noise_square * m.pixels;  // half of the noise is the template's
  const Eigenvalues e = eigenvalues(m.information);
  if (e.largest < kLeast * false_part) return 0;
  information = {m.information.xx - false_part, m.information.xy, m.information.yy - false_part};
  if (is_edge(along)) return 1;
  if (e.smallest >= kLeast * false_part && e.smallest > kEdgeRatio * e.largest) return 2;
  along = strongest_direction(m.information, e.smallest);
  return 1;
}

// (s^-1 noise + floor^2)^-1 in one direction.
Sym2 along_alone(const Sym2& s, Vec2 n, float noise, float floor_px) {
  const float v = s.xx * n.x * n.x + 2 * s.xy * n.x * n.y + s.yy * n.y * n.y;
  const float w = v / (noise + floor_px * floor_px * v);
  return {w * n.x * n.x, w * n.x * n.y, w * n.y * n.y};
}

}  // namespace

void describe(const Measurement& m, Vec2 along, const PatchOptions& o, PatchResult& r) {
  constexpr float kLeastNoise = 1e-3f;  // grey^2, should an option say that there is none
  r.gain = m.gain;
  r.bias = m.bias;
  r.correlation = m.correlation;
  r.residual = square_root(m.residual_square);
  const float noise = max(max(m.noise_square, o.noise_floor_grey * o.noise_floor_grey), kLeastNoise);
  Sym2 s = m.information;
  r.rank = o.takes_edges ? rank_of(m, s, along) : 2;
  if (r.rank == 2) r.information = floored(s, noise, o.position_floor_px);
  if (r.rank == 1) r.information = along_alone(s, along, noise, o.position_floor_px);
}

float distance_seen(Vec2 d, const PatchResult& r) {
  const Sym2& s = r.information;
  if (r.rank == 2) return length(d);
  return square_root((s.xx * d.x * d.x + 2 * s.xy * d.x * d.y + s.yy * d.y * d.y) / (s.xx + s.yy));
}

PatchStatus judge(const PatchResult& r, Vec2 start, const PatchOptions& o) {
  if (r.rank == 0) return PatchStatus::flat;
  if (r.correlation < o.min_correlation) return PatchStatus::low_correlation;
  if (r.gain < o.min_gain || r.gain > o.max_gain || magnitude(r.bias) > o.max_bias)
    return PatchStatus::bad_light;
  if (o.max_move_px > 0 && length(r.x - start) > o.max_move_px) return PatchStatus::diverged;
  return PatchStatus::ok;
}

}  // namespace patch

}  // namespace pliant
