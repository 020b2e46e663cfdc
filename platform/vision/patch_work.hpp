#pragma once
// What one search of the patch tracker works on, and its three steps: making a template, finding where the
// image is like it, and measuring where exactly.
#include "vision/patch_kernels.hpp"
#include "pliant/patch_tracker.hpp"

namespace pliant::patch {

/// One slot: where its patch was captured, and on how many levels. None: empty.
struct Anchor {
  Vec2 x;
  int levels;
};

/// One slot on one level: a square of stored pixels around the pixel nearest to the captured point.
struct Surround {
  Vec2 offset;                            ///< from that pixel to the point, within half a pixel
  std::int16_t left, top, right, bottom;  ///< what of it lies in the image, [left, right) x [top, bottom)
};

constexpr int surround_side(const PatchLimits& l) {
  return l.window + 2 + 2 * l.margin;
}

/// The image changes by a multiple of each of these: light, a stretch or turn of the window, and a shift.
constexpr int kLight = 0, kShift = 5, kMotions = 7;  // 1 to 4: stretch

struct System;  // of patch_refine.cpp

/// Arrays of one search, sized for the window.
struct Work {
  int window, count;         ///< side; elements of an array
  std::int16_t* block;       ///< pixels around a window
  std::int16_t* scratch;     ///< for the kernels
  std::int16_t *all, *part;  ///< masks: the whole window, and what of it lies inside the source
  Template plain;            ///< in use: `own`, or a slot's
  Template own;
  std::int16_t *x, *y;             ///< of each pixel of the window, from its middle
  std::int16_t* stretch[4];        ///< x gx, y gx, x gy, y gy of the template
  std::int16_t* masked[kMotions];  ///< all of these without the pixels that are clipped in the current image
  std::int16_t* unclipped;         ///< the mask of those
  std::int16_t* image;             ///< the current image, sampled
  std::uint8_t* bytes;             ///< pixels near the border, collected with their edge repeated
  /// Equations of `refine`: of all pixels (`own_whole`, or a slot's), of those that are not clipped.
  System *whole, *own_whole, *partial;
  bool is_prepared;  ///< `whole` are those of `plain`
  Mat2 warp_left;    ///< of the warp predicted, what `plain` has not been put through, less the identity

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

/// Room for one.
System* take_system(Arena& arena);
/// Room for a template, zero.
Template take_template(Arena& arena, int window);

/// A slot's template at full size and its equations, as long as they will do.
struct Kept {
  Template images;
  System* whole;
  Mat2 warp;  ///< for which they were made
  float warp_sd, min_eigenvalue;
  bool takes_edges, masks_clipped, is_made;
};

/// Loads work.block with pixels from (left, top) on; beyond the image its edge is repeated.
void load_block(const ImageView& image, int left, int top, Work& work);

/// Makes work.plain from the window at (left, top) of an image.
void load_template(const ImageView& image, int left, int top, GreyRange range, Work& work);
/// Makes work.plain from a stored square, straight (`to_anchor` null) or warped: pixel d from the centre is
/// the square's at *to_anchor * d from its centre.
void load_template(const Surround& around, const std::uint8_t* pixels, int side, const Mat2* to_anchor,
                   GreyRange range, Work& work);
/// Fills a surround and its pixels from the image; x is in the level's pixels.
void store_surround(const ImageView& image, Vec2 x, int side, Surround& around, std::uint8_t* pixels);

/// Scharr's gradients smooth, and so fall short of the slope by about a tenth on most textures; steps
/// computed from them are too long by as much.
constexpr float kStepScale = 0.9f;

/// Sum of (a - mean a) (b - mean b) from plain sums over n pixels: exact but for two roundings at the end.
inline float centred(std::int64_t n, float inverse_n, std::int32_t ab, std::int32_t a, std::int32_t b) {
  return static_cast<float>(n * ab - std::int64_t{a} * b) * inverse_n;
}

/// Texture without which there is no search: this smaller eigenvalue of the mean structure tensor, light projected out,
/// in (grey/px)^2; where an edge will do, the larger one.
struct TextureNeeded {
  float min_eigenvalue;
  bool edge_will_do;
};
/// Ratio of the eigenvalues from which on a patch has texture in one direction only, where that is asked.
constexpr float kEdgeRatio = 0.05f;

/// What a patch offers: its pixels, and the sums of its squared grey levels (centred) and of the products of its gradients
/// (light projected out), in the kernels' units.
struct Texture {
  std::int64_t pixels;
  float variance_sum;
  Sym2 tensor;
};

/// Whether it can be searched for: enough pixels, and texture in both directions. Where an edge will do, texture in one
/// is enough; `along` is then its unit direction, and zero otherwise.
bool is_usable(const Texture& texture, int window, const TextureNeeded& needed, Vec2& along);

/// Whether work.plain can.
bool has_texture(const Work& work, const TextureNeeded& needed);

struct SearchOptions {
  int max_iterations;
  float epsilon_px;
  TextureNeeded texture;
  GreyRange range;
  bool needs_whole_window;  ///< the window may not leave the image; otherwise only its centre
  bool starts_cheaply;      ///< a first step of `refine` with linear samples: it is not going to be the last
};

/// The middle of the window in the image, and how often it was compared.
struct Position {
  Vec2 y;
  int iterations = 0;
  Vec2 along;  ///< unit direction to which an edge confines the search; zero: a corner
};

/// Whether a direction was set.
inline bool is_edge(Vec2 along) {
  return along.x != 0 || along.y != 0;
}

/// Moves p until the image there, but for light, is like work.plain. On success p is right to about the
/// options' epsilon; it may start half a window away.
PatchStatus align(const ImageView& image, const SearchOptions& options, Work& work, Position& p);

/// What `refine` says about the place that it found. Greys and pixels.
struct Measurement {
  Sym2 information;  ///< for a noise of one grey level
  float gain = 0, bias = 0, correlation = 0;
  float pixels = 0;           ///< compared
  float residual_square = 0;  ///< mean
  float noise_square = 0;     ///< variance of the noise that would leave this residual
};

/// Measures p to a hundredth of a pixel, from up to half a pixel away. Besides light, it allows for a warp
/// that was not predicted, of standard deviation `warp_sd` in each entry; 0: for none.
PatchStatus refine(const ImageView& image, const SearchOptions& options, float warp_sd, Work& work,
                   Position& p, Measurement& m);

/// A position on the sampling grid, 1/128 px.
struct GridPosition {
  int x, y;
};
constexpr int kPhase = kSubpixel - 1;  ///< mask of the part of a pixel
GridPosition on_grid(Vec2 p);
inline Vec2 position(GridPosition p) {
  return {static_cast<float>(p.x) / kSubpixel, static_cast<float>(p.y) / kSubpixel};
}
/// Loads work.block with the image around p; gives it.
const std::int16_t* load_at(const ImageView& image, GridPosition p, Work& work);
/// Whether none of the template's pixels is clipped in work.image; where some are, the others' mask is work.unclipped.
bool all_count(GreyRange range, int pixels, Work& work);
/// Whether the window (or its middle alone) lies inside the image.
bool is_inside(const ImageView& image, GridPosition p, int radius);

}  // namespace pliant::patch
