#pragma once
// The arrays that one search of the patch tracker works on.
#include "pliant/arena.hpp"
#include "pliant/geometry.hpp"
#include "vision/patch_arrays.hpp"

namespace pliant::patch {

struct WarpSystem;

/// A template over its window: grey levels, their gradients (zero where the mask is 0), and the mask of usable pixels.
/// Arrays of padded(window) elements.
struct Template {
  i16 *t, *gx, *gy, *m;
};
/// A template's arrays, zero.
Template take_template(Arena& arena, int window);
/// An equation system; null if the arena only measures or is exhausted.
WarpSystem* take_warp_system(Arena& arena);

/// Images that the current image is explained by: a ramp of light (2), light, stretch or turn (4), shift (2).
constexpr int kRamp = 0, kLight = 2, kStretch = 3, kShift = 7, kUnknowns = 9;

/// Arrays of one search, sized for one window.
struct Workspace {
  int window, count;       ///< side, px; elements of an array: padded(window)
  i16* block;              ///< pixels around a window
  i16* scratch;            ///< of the kernels
  i16 *all, *part;         ///< masks: the whole window; its pixels inside the source
  i16 *x, *y;              ///< of each pixel, from the window's middle
  i16* ramp[2];            ///< x and y under the template's mask
  i16* stretch[4];         ///< x gx, y gx, x gy, y gy of the template, over 16
  i16* unclipped;          ///< mask of the template's pixels that are not clipped in the current image
  i16* masked[kUnknowns];  ///< the images under that mask
  i16* image;              ///< the current image, sampled
  std::uint8_t* bytes;     ///< pixels beside the border, with the border repeated

  Template own_template;         ///< made for one search
  WarpSystem* own_system;        ///< its equations, of all pixels
  WarpSystem* unclipped_system;  ///< the equations of `unclipped`
  Template active;               ///< the template in use: `own_template`, or a cached one
  WarpSystem* system;            ///< its equations: `own_system`, or cached ones
  bool has_system;               ///< `system` is that of `active`
  float ramp_sd;  ///< PatchOptions::ramp_sd of the search
  Mat2 residual_warp;  ///< what of the predicted warp `active` is not resampled by, less the identity

  void lay_out(Arena& arena, int window_side);
};

}  // namespace pliant::patch
