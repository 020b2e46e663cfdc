#pragma once
// The window of the current image at a position.
#include "pliant/pyramid.hpp"
#include "vision/patch_workspace.hpp"

namespace pliant::patch {

/// A position on the sampling grid, 1/128 px.
struct GridPosition {
  int x, y;
};
/// The nearest grid position. Precondition: above -64 px either way.
GridPosition on_grid(Vec2 p);
inline Vec2 position(GridPosition p) {
  return {static_cast<float>(p.x) / kSubpixel, static_cast<float>(p.y) / kSubpixel};
}
/// The part of a coordinate between pixels, 1/128 px.
constexpr int phase(int coordinate) {
  return coordinate & (kSubpixel - 1);
}

/// True if a square of this radius around p lies inside the image.
bool is_inside(const ImageView& image, GridPosition p, int radius);

enum class Sampling { linear, cubic };
/// Samples the image around p into work.image. Beyond the image its border is repeated.
void sample_window(const ImageView& image, GridPosition p, Sampling sampling, Workspace& work);

/// True if none of the `pixels` usable pixels of work.active is clipped in work.image. Otherwise work.unclipped is
/// the mask of those that are not.
bool is_all_unclipped(int pixels, Workspace& work);

}  // namespace pliant::patch
