#pragma once
// The search for one template from coarse to fine.
#include "vision/patch_slots.hpp"

namespace pliant::patch {

/// Where a template comes from: around x in a pyramid, or a slot, under a warp.
struct TemplateSource {
  const Pyramid* pyramid;  ///< null: a slot
  Vec2 x;                  ///< px of level 0, if from a pyramid
  int slot;
  Mat2 warp, to_template;  ///< from template to image, and its inverse
  float strain_px;         ///< how far the warp moves the edge of the window

  static TemplateSource around(const Pyramid& pyramid, Vec2 x) { return {&pyramid, x, -1, {}, {}, 0}; }
  static TemplateSource of_slot(int slot, const Mat2& warp, int window);
};

/// True if a square of radius `margin` px around x lies inside the image.
bool contains(const ImageView& image, Vec2 x, int margin);

/// What all searches of a tracker work with.
struct SearchState {
  PatchSlots slots;
  Workspace work;

  void lay_out(Arena& arena, const PatchLimits& limits) {
    slots.lay_out(arena, limits);
    work.lay_out(arena, limits.window);
  }
};

/// Makes the template of one level in state.work.
/// \return the vector from its centre to the point, px of that level of the current image.
Vec2 load_level(SearchState& state, const TemplateSource& source, int level, bool accepts_edges);

/// Finds the source's template in `current`. \return as PatchTracker::track.
PatchResult search(SearchState& state, const TemplateSource& source, const Pyramid& current, Vec2 start,
                   const PatchOptions& options);

}  // namespace pliant::patch
