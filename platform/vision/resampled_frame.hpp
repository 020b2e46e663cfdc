#pragma once
// A frame at another size.
#include "pliant/geometry.hpp"
#include "pliant/pyramid.hpp"

namespace pliant {

/// Grey levels of a frame reduced to `ratio` times its size, sampled bilinearly on the pyramid level that is up to
/// twice as fine. A ratio above 1 samples the frame itself. Precondition: the pyramid is built and outlives this.
class ResampledFrame {
 public:
  ResampledFrame(const Pyramid& pyramid, float ratio);
  /// The grey level at x, px of the frame (not of the reduced one). Beyond the image its border is repeated; NaN
  /// gives the upper left pixel.
  std::uint8_t grey(Vec2 x) const;

 private:
  ImageView image_;
  float level_scale_ = 1;  // of the level to the frame
};

}  // namespace pliant
