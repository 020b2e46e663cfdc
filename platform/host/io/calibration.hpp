#pragma once
/// \file calibration.hpp
/// Known intrinsics and lens, as OpenCV's calibration writes them.
#include <string>

#include "host/io/image.hpp"
#include "pliant/lens.hpp"

namespace pliant::host {

/// What a calibration comes to with two radial coefficients.
struct Calibration {
  Camera camera;
  float off_px = 0;  ///< how far, at worst over the picture, two coefficients are from all that the file has
};

/// Reads `image_width`, `image_height`, `camera_matrix` (3 x 3) and `distortion_coefficients` (4 to 14 numbers, or none) of
/// an OpenCV FileStorage YAML file, for pictures of `size`: those of the file, or a uniform scale of them. More than k1 and
/// k2 is brought down to two coefficients by least squares over the picture. Bad input, with the reason, for anything
/// else; a lens that cannot be undone; or one that two coefficients describe worse than to a hundredth of the width.
Calibration parse_calibration(const std::string& source, const std::string& text, const ImageSize& size);

/// The lens of a camera whose pictures have this size. Bad input when there can be no such lens.
Lens lens_of(const Camera& camera, const ImageSize& size);

}  // namespace pliant::host
