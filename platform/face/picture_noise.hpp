#pragma once
// Smoothing of the noise in pictures of a face (docs/algorithms.md, section 7.22).
#include <cstdint>

namespace pliant {

/// Tuning of the smoothing. Each constant: unit, reason, experiment.
struct PictureNoiseTuning {
  /// Noise over contrast (`FrameNoise`) from which on a picture is smoothed once, and from which on twice. Chosen on films of
  /// portraits in low light: docs/experiments.md, Noise of pictures.
  float noisy = 0.1f, very_noisy = 0.45f;
};
inline constexpr PictureNoiseTuning kPictureNoiseTuning{};

/// Largest side of a picture that is smoothed, px: bounds the stack.
constexpr int kMostPictureSide = 160;

/// Smooths a square picture in place by [1 2 1]/4 along rows and columns if it is noisy, twice if it is very noisy. Beyond the
/// border its pixels go on. Cost: `noise_of`, and 6 additions a pixel each time.
/// \param pixels  rows without padding. \param side  px, 1 to kMostPictureSide. \param most_places  as in `noise_of`.
void smooth_noise(std::uint8_t* pixels, int side, int most_places);

}  // namespace pliant
