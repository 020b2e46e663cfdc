#include "vision/patch_texture.hpp"

#include "base/symmetric.hpp"
#include "vision/patch_arrays.hpp"
#include "vision/patch_tuning.hpp"

namespace pliant::patch {

bool is_usable(const Texture& t, int window, bool accepts_edges, Vec2& along) {
  constexpr const PatchTuning& tuning = kPatchTuning;
  constexpr float kScale = kGreyScale * kGreyScale;
  const float min_ratio = accepts_edges ? tuning.edge_eigenvalue_ratio : tuning.min_eigenvalue_ratio;
  const auto pixels = static_cast<float>(t.pixels);
  along = {};
  if (tuning.min_pixel_divisor * t.pixels < window * window) return false;
  if (t.variance_sum < tuning.min_variance * kScale * pixels) return false;
  const float least = tuning.min_eigenvalue * kScale * pixels;
  const Eigenvalues e = eigenvalues(t.tensor);
  if (e.smallest > min_ratio * e.largest && e.smallest >= least) return true;
  if (!accepts_edges || !(e.largest > 0) || e.largest < least) return false;
  along = strongest_direction(t.tensor, e.smallest);
  return true;
}

}  // namespace pliant::patch
