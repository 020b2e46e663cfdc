#include "vision/patch_window.hpp"

#include "vision/patch_sampling.hpp"
#include "vision/patch_sums.hpp"
#include "vision/patch_template.hpp"

namespace pliant::patch {

GridPosition on_grid(Vec2 p) {
  constexpr int kMargin = 64;  // px; keeps the conversion, which cuts towards zero, on the positive side
  PLIANT_ASSERT(p.x > -kMargin && p.y > -kMargin);
  const auto fixed = [](float v) {
    return static_cast<int>((v + kMargin) * kSubpixel + 0.5f) - kMargin * kSubpixel;
  };
  return {fixed(p.x), fixed(p.y)};
}

bool is_inside(const ImageView& image, GridPosition p, int radius) {
  const int lo = radius * kSubpixel;
  return p.x >= lo && p.y >= lo && p.x <= (image.width - 1) * kSubpixel - lo &&
         p.y <= (image.height - 1) * kSubpixel - lo;
}

void sample_window(const ImageView& image, GridPosition p, Sampling sampling, Workspace& work) {
  const int w = work.window, fx = phase(p.x), fy = phase(p.y);
  const int left = (p.x - fx) / kSubpixel - w / 2, top = (p.y - fy) / kSubpixel - w / 2;
  load_block(image, left - 1, top - 1, work);
  (sampling == Sampling::linear ? sample_linear : sample_cubic)(work.block, fx, fy, w, work.scratch,
                                                                work.image);
}

bool is_all_unclipped(int pixels, Workspace& work) {
  if (is_within(work.image, work.count, kUsableGrey)) return true;
  return mask_extremes(work.image, work.active.m, work.count, kUsableGrey, work.unclipped) == pixels;
}

}  // namespace pliant::patch
