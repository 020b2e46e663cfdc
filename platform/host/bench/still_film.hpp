#pragma once
/// \file still_film.hpp
/// Films made of photographs: what a camera on a shaking hand sees of a still scene, with its noise.
#include <cstdint>

#include "host/io/image.hpp"
#include "pliant/frame.hpp"
#include "pliant/geometry.hpp"

namespace pliant::host {

/// How a film of a photograph moves.
struct StillFilmOptions {
  float drift_px = 3;    ///< largest shift from the first frame
  float noise_grey = 2;  ///< standard deviation of the noise of each pixel
  std::uint32_t seed = 1;
};

/// A film of one photograph: frame k shows it shifted by `shift(k)`, with new noise.
class StillFilm {
 public:
  /// \param picture  grey; outlives this object.
  explicit StillFilm(const Image& picture, const StillFilmOptions& options = {})
      : picture_(picture), options_(options) {}

  /// Where the photograph's pixel (0,0) is in frame k. (0,0) in frame 0; a slow loop of 60 frames.
  Vec2 shift(std::size_t k) const;
  /// Frame k; valid until the next call. 30 frames a second.
  FrameView frame(std::size_t k);

 private:
  const Image& picture_;
  StillFilmOptions options_;
  Image frame_;
};

/// A picture at another size, averaged over the area of its pixels where it shrinks and bilinear where it grows.
Image resized(const Image& grey, float scale);

/// A picture turned about its middle, clockwise, bilinear; beyond its border it repeats its border pixels.
Image turned(const Image& grey, float radians);

/// Lays a picture over another at (x, y), with a soft border of `margin` pixels.
void lay_over(Image& background, const Image& picture, int x, int y, int margin);

/// Grey noise with this standard deviation, the same for the same seed on every machine.
void add_grey_noise(Image& image, float standard_deviation, std::uint32_t seed);

}  // namespace pliant::host
