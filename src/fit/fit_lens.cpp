// A fit through a known lens: to points as the pinhole would have seen them.
#include "pliant/fit.hpp"
#include "pliant/lens.hpp"

namespace pliant {

Status Fitter::fit(Span<const Correspondence> points, const FitOptions& options, float* q, FitReport* report,
                   float* sd, Vec2* residuals, float* weights) {
  if (options.camera == nullptr) return fit_ideal(points, options, q, report, sd, residuals, weights);
  Lens lens;
  const Status made = Lens::make(*options.camera, options.width, options.height, &lens);
  if (made != Status::ok) return made;
  if (points.count > limits_.points) return Status::capacity;
  for (std::size_t i = 0; i < points.count; ++i) {
    ideal_[i] = points[i];
    if (is_finite(points[i].x)) ideal_[i].x = lens.undistort(points[i].x);
  }
  FitOptions known = options;
  known.focal_px = options.camera->f;
  const Status status = fit_ideal({ideal_, points.count}, known, q, report, sd, residuals, weights);
  if (status != Status::ok) return status;
  for (std::size_t i = 0; residuals != nullptr && i < points.count; ++i)
    residuals[i] = lens.distort(ideal_[i].x + residuals[i]) - points[i].x;
  return status;
}

}  // namespace pliant
