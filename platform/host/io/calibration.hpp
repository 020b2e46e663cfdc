#pragma once
/// \file calibration.hpp
/// Known intrinsics and lens, as OpenCV's calibration writes them.
#include <cstddef>
#include <string>

#include "host/io/image.hpp"
#include "pliant/lens.hpp"

namespace pliant::host {

/// A calibration reduced to two radial coefficients.
struct Calibration {
  Camera camera;
  float off_px = 0;  ///< largest error of the two coefficients over the picture, px
};

/// Bytes of a calibration, at most: they have a few hundred, or tens of thousands with the points that were used.
constexpr std::size_t kMostCalibrationBytes = std::size_t{1} << 20;

/// Reads `image_width`, `image_height`, `camera_matrix` (3 x 3) and `distortion_coefficients` (4 to 14 numbers, or none) of
/// an OpenCV FileStorage YAML file, for pictures of `size`: those of the file, or a uniform scale of them. Other
/// coefficients than k1 and k2 are reduced to these two by least squares over the picture. Bad input: anything else, more than
/// kMostCalibrationBytes, a lens that cannot be inverted, or an error of the two coefficients above a hundredth of the width.
Calibration parse_calibration(const std::string& source, const std::string& text, const ImageSize& size);

/// The lens of a camera for pictures of this size. Bad input if the lens cannot be inverted.
Lens lens_of(const Camera& camera, const ImageSize& size);

}  // namespace pliant::host
