#include "vision/normal_flow.hpp"

#include "base/symmetric.hpp"
#include "vision/patch_tuning.hpp"

namespace pliant {

namespace {

using patch::kPatchTuning;

// The fraction of white noise's variance in Scharr gradients: 2 (3^2 + 10^2 + 3^2) / 32^2.
constexpr float kScharrNoise = 0.23f;

int measure(const patch::Measurement& m, Vec2 along, float noise, Sym2* information) {
  // Part of the gradients is noise of the template, which carries no information about the position. Half of the noise is the
  // template's.
  const float noise_part = kScharrNoise * 0.5f * m.noise_square * m.pixels;
  const float least = kPatchTuning.min_gradient_to_noise * noise_part;
  const Eigenvalues e = eigenvalues(m.information);
  if (e.largest < least) return 0;
  Sym2& s = *information;
  s = {m.information.xx - noise_part, m.information.xy, m.information.yy - noise_part};
  if (!patch::is_edge(along)) {
    if (e.smallest >= least && e.smallest > kPatchTuning.edge_eigenvalue_ratio * e.largest) return 2;
    along = strongest_direction(m.information, e.smallest);
  }
  const float v = quadratic_form(s, along);
  // Of a search that an edge has confined only this counts: the largest eigenvalue is of what is added along the edge (confine).
  if (v < least - noise_part) return 0;
  // (v^-1 noise + floor^2)^-1, in this direction only.
  const float w = v / (noise + kPatchTuning.position_floor_px * kPatchTuning.position_floor_px * v);
  s = {w * along.x * along.x, w * along.x * along.y, w * along.y * along.y};
  return 1;
}

}  // namespace

const NormalFlow kNormalFlow{measure};

}  // namespace pliant
