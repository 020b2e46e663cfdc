#pragma once
/// \file calibration_option.hpp
/// The options --calibration and --focal of the commands that need a camera.
#include <optional>
#include <ostream>

#include "host/commands/args.hpp"
#include "pliant/camera.hpp"

namespace pliant::host {

/// The camera of the file that --calibration names, for pictures of `size`; nothing without the option. Writes a note on
/// `err` when two radial coefficients differ from the file's lens by more than a tenth of a pixel. Bad usage together with
/// --focal; bad input as parse_calibration.
std::optional<Camera> calibration_of(const Args& args, const ImageSize& size, std::ostream& err);

/// The focal length that --focal gives, pixels; 0 without the option. Writes a note on `err` when hardly a camera has it for
/// pictures of `size`, as when it was given in millimetres.
float focal_of(const Args& args, const ImageSize& size, std::ostream& err);

}  // namespace pliant::host
