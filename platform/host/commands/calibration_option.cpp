#include "host/commands/calibration_option.hpp"

#include <cmath>

#include "host/io/calibration.hpp"
#include "host/io/failure.hpp"
#include "host/io/files.hpp"
#include "host/io/numbers.hpp"

namespace pliant::host {

namespace {
constexpr float kNotedErrorPx = 0.1f;  // half of the error of a good match
}  // namespace

std::optional<Camera> calibration_of(const Args& args, const ImageSize& size, std::ostream& err) {
  const auto path = args.text("--calibration");
  if (!path) return std::nullopt;
  if (args.has("--focal")) fail_usage("--calibration and --focal exclude each other");
  const Calibration calibration = parse_calibration(*path, read_file(*path, kMostCalibrationBytes), size);
  if (calibration.off_px > kNotedErrorPx)
    err << *path << ": reduced to two radial coefficients; the error is up to "
        << number_text(static_cast<double>(std::round(100 * calibration.off_px) / 100)) << " px\n";
  return calibration.camera;
}

}  // namespace pliant::host
