#pragma once
// Refinement of a template's position at full size, with the uncertainty of the result.
#include "vision/patch_align.hpp"

namespace pliant::patch {

/// The fit of a template at the refined position. Greys and pixels.
struct Measurement {
  Sym2 information;  ///< of the position, for noise of one grey level; 1/px^2
  float gain = 0, bias = 0, correlation = 0;
  float pixels = 0;           ///< compared
  float residual_square = 0;  ///< mean, grey^2
  float noise_square = 0;     ///< variance of the noise of a pixel that leaves this residual, grey^2
};

/// Moves p to the minimum, from up to half a pixel away, to about PatchTuning::epsilon_px. Allows for gain, bias and
/// a warp that was not predicted. \return flat, outside_image or diverged; `result` is then as it was.
PatchStatus refine(const ImageView& image, const SearchOptions& options, Workspace& work, SearchPosition& p,
                   Measurement& result);

}  // namespace pliant::patch
