#include "host/commands/calibration_option.hpp"

#include <algorithm>
#include <cmath>

#include "host/io/calibration.hpp"
#include "host/io/failure.hpp"
#include "host/io/files.hpp"
#include "host/io/numbers.hpp"

namespace pliant::host {

namespace {
constexpr float kNotedErrorPx = 0.1f;  // half of the error of a good match
/// Focal lengths that are noted: below and above these multiples of the larger side, which sees 127 and 2.9 degrees. Round values.
constexpr float kShortest = 0.25f, kLongest = 20;
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

float focal_of(const Args& args, const ImageSize& size, std::ostream& err) {
  const auto f = static_cast<float>(args.number("--focal", 0, 1, 1e6));
  const auto side = static_cast<float>(std::max(size.width, size.height));
  if (f > 0 && (f < kShortest * side || f > kLongest * side))
    err << "--focal " << *args.text("--focal") << " is implausibly " << (f < side ? "short" : "long")
        << " for pictures of " << size.width << "x" << size.height
        << " pixels: it is in pixels, and usually 0.5 to 3 times the larger side\n";
  return f;
}

}  // namespace pliant::host
