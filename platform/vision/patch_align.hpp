#pragma once
// Coarse alignment of a template by translation.
#include "pliant/patch_tracker.hpp"
#include "vision/patch_texture.hpp"
#include "vision/patch_workspace.hpp"

namespace pliant::patch {

/// Where a search stands: the window's centre in the image.
struct SearchPosition {
  Vec2 x;              ///< px of the level
  int iterations = 0;  ///< steps made
  Vec2 along;          ///< unit direction of the only texture there is; zero: in both directions
};

/// How a level is searched.
struct SearchOptions {
  bool accepts_edges;       ///< texture in one direction is enough
  bool needs_whole_window;  ///< the window may not leave the image; otherwise its centre may not
  bool is_far;  ///< the first step of `refine` is sampled bilinearly, because it will not be the last
};

/// Moves p until the image there is like work.active but for gain and bias. Converges from half a window away to about
/// PatchTuning::align_stop_ratio * epsilon_px. \return flat, outside_image or diverged; then p is where it stopped.
PatchStatus align(const ImageView& image, const SearchOptions& options, Workspace& work, SearchPosition& p);

/// Whether work.active can be matched.
bool has_texture(const Workspace& work, bool accepts_edges);

}  // namespace pliant::patch
