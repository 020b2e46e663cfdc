#pragma once
// Templates: stored from an image, and made ready for a search from an image or from what is stored.
#include "pliant/patch_tracker.hpp"
#include "vision/patch_workspace.hpp"

namespace pliant::patch {

/// A stored template on one pyramid level: a square of pixels around the pixel nearest to the captured point. The
/// pixels themselves stand apart, row by row.
struct StoredTemplate {
  Vec2 offset;  ///< from that pixel to the point, within half a pixel
  std::int16_t left, top, right,
      bottom;  ///< the part of the square inside the image: [left, right) x [top, bottom)
};
/// Side of the stored square, px: the window, a pixel around it for gradients, and the template margin.
constexpr int stored_side(const PatchLimits& l) {
  return l.window + 2 + 2 * l.margin;
}

/// Fills a stored template and its pixels from the image around x, px of this image. Beyond the image its border is
/// repeated.
void store_template(const ImageView& image, Vec2 x, int side, StoredTemplate& stored, std::uint8_t* pixels);

/// Makes work.active from the window of an image with its upper left pixel at (left, top).
void load_template(const ImageView& image, int left, int top, Workspace& work);
/// Makes work.active from a stored template. Pixel d from its centre is the stored square's at *to_template * d;
/// unwarped if to_template is null. Pixels that leave the square are masked out.
void load_template(const StoredTemplate& stored, const std::uint8_t* pixels, int side,
                   const Mat2* to_template, Workspace& work);

/// Loads work.block with pixels from (left, top) on. Beyond the image its border is repeated.
void load_block(const ImageView& image, int left, int top, Workspace& work);

/// Fills `out` from a block: grey levels and Scharr gradients (3 10 3; 1/16 grey/px) where `mask` is 1 and the pixel
/// is not clipped. \param scratch  scratch_size(window) elements.
void make_template(const i16* block, const i16* mask, int window, i16* scratch, Template out);

}  // namespace pliant::patch
