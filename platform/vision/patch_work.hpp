#pragma once
// What one search of the patch tracker works on, and its two steps: making a template, and aligning an image
// with it.
#include "patch_kernels.hpp"
#include "pliant/patch.hpp"

namespace pliant::patch {

/// One slot: where its patch was captured, and on how many levels. None: empty.
struct Anchor {
  Vec2 x;
  int levels;
};

/// One slot on one level: a square of stored pixels around the pixel nearest to the captured point.
struct Surround {
  Vec2 offset;  ///< from that pixel to the point, within half a pixel
  std::int16_t left, top, right,
      bottom;  ///< the part of the square, [left, right) x [top, bottom), inside the image
};

constexpr int surround_side(const PatchLimits& l) {
  return l.window + 2 + 2 * l.margin;
}

/// Arrays of one search, sized for the window.
struct Work {
  int window, count;       ///< side; elements of an array
  std::int16_t* block;     ///< the template with one pixel more on each side
  std::int16_t* all;       ///< a mask with the whole window in it
  Template plain, masked;  ///< the template; and without the pixels that are clipped in the current image
  std::int16_t* image;     ///< the current image, sampled
  std::uint8_t* bytes;     ///< pixels near the border, collected with their edge repeated

  void lay_out(Arena& arena, int window_side);
};

/// Bounds of usable grey levels, in the kernels' units.
struct GreyRange {
  int lowest, highest;
};
constexpr GreyRange usable_range(bool masks_clipped) {
  return masks_clipped ? GreyRange{5 * kGreyScale - kGreyOffset, 250 * kGreyScale - kGreyOffset}
                       : GreyRange{-kGreyOffset - 1, kGreyOffset};
}

/// `rows` x `columns` readable pixels at (left, top): in place, or where the image ends, a copy with its edge
/// repeated.
Pixels readable(const ImageView& image, int left, int top, int rows, int columns, std::uint8_t* scratch);

/// Makes work.plain from the window at (left, top) of an image.
void load_template(const ImageView& image, int left, int top, GreyRange range, Work& work);
/// Makes work.plain from a stored square, straight (`to_anchor` null) or warped: pixel d from the centre is
/// the square's at *to_anchor * d from its centre.
void load_template(const Surround& around, const std::uint8_t* pixels, int side, const Mat2* to_anchor,
                   GreyRange range, Work& work);
/// Fills a surround and its pixels from the image; x is in the level's pixels.
void store_surround(const ImageView& image, Vec2 x, int side, Surround& around, std::uint8_t* pixels);

/// What is constant in a search: the template's moments, light projected out.
struct Normal {
  float n = 0;                       ///< pixels that count
  float mean = 0, variance_sum = 0;  ///< of the template
  Vec2 light;   ///< of each gradient image, the multiple of the template that is taken out
  Sym2 tensor;  ///< sum of products of the gradient images, both light terms taken out
  TemplateSums sums;
};
Normal normal_of(const TemplateSums& sums);
/// False when the search could not be solved with it: too few pixels or texture in one direction only.
bool is_usable(const Normal& normal, int window, float min_eigenvalue);

/// One search on one level.
struct Alignment {
  Vec2 y;  ///< centre of the window in the image; start, then result
  int iterations = 0;
  Normal normal;    ///< of the template as last used
  ImageSums image;  ///< of the last sampling
  const std::int16_t* mask = nullptr;
  int fx = 0, fy = 0;  ///< phase of the last sampling, 1/128 px
};

struct AlignOptions {
  int max_iterations;
  float epsilon_px;
  float min_eigenvalue;
  GreyRange range;
  bool masks_clipped;
  bool needs_whole_window;  ///< the window may not leave the image; otherwise only its centre
};

/// Moves a.y until the image there, but for light, matches work.plain.
PatchStatus align(const ImageView& image, const AlignOptions& options, Work& work, Alignment& a);

}  // namespace pliant::patch
