#pragma once
// The derivative of an image along the normal of an expected edge.
#include <cstdint>

#include "pliant/geometry.hpp"
#include "pliant/pyramid.hpp"

namespace pliant {

/// Samples that a derivative and its two neighbours need beyond a step.
constexpr int kProfileBorder = 3;
/// Steps searched to either side, at most. One step is one pixel of the level.
constexpr int kMaxProfileReach = 16;
/// Width of the strip that is summed, samples.
constexpr int kProfileLines = 5;
/// Samples are in sixteenths of a grey level.
constexpr int kProfileGreyScale = 16;

/// Derivatives at the steps [first, first + count) from the expected position, by the antisymmetric kernel (-1 -2 0 2
/// 1) summed over the strip: a step of h grey levels gives 3 * kProfileLines * kProfileGreyScale * h.
struct EdgeProfile {
  int first = 0, count = 0;  ///< count 0: the strip does not fit around the position
  std::int32_t derivative[2 * (kMaxProfileReach + kProfileBorder) + 1];
  float noise = 0;  ///< variance of a sample, by the differences across the strip; samples squared
};

/// Samples a strip of the image around x (px), `reach` steps to either side along the unit vector `normal`, or as far
/// as the image goes. Bilinear, integers only. Precondition: x and its right and lower neighbours inside the image,
/// reach at most kMaxProfileReach.
void sample_profile(const ImageView& image, Vec2 x, Vec2 normal, int reach, EdgeProfile& profile);

/// Factors by which the sums over the strip amplify the variance of its samples. Neighbouring samples are correlated.
struct NoiseGain {
  float derivative;  ///< weights -1 -2 0 2 1 along the strip
  float difference;  ///< of the derivatives on both sides: 1 2 -1 -4 -1 2 1
  float bend;        ///< their second difference: -1 0 3 0 -3 0 1
};
/// \param one, two  correlation of samples one and two steps apart.
constexpr NoiseGain noise_gain(float one, float two) {
  const float lines = 5 + 8 * one + 6 * two;
  return {lines * (10 + 8 * one - 8 * two), lines * (28 + 16 * one - 34 * two), lines * (20 - 30 * two)};
}
/// Noise gains of level 0 (white noise, sampled bilinearly) and of coarser levels (noise that the pyramid has
/// smoothed), averaged over all sub-pixel positions.
inline constexpr NoiseGain kWhiteNoiseGain = noise_gain(0.25f, 0),
                           kSmoothedNoiseGain = noise_gain(0.6f, 0.1f);
/// Fraction of white noise's variance that bilinear sampling leaves, averaged over all sub-pixel positions.
constexpr float kSampledNoise = 4.0f / 9;

}  // namespace pliant
