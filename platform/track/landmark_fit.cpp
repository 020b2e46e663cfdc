#include "track/landmark_fit.hpp"

#include <new>

#include "track/personal_landmarks.hpp"

namespace pliant {

namespace {

FitLimits limits_for(std::size_t points) {
  FitLimits limits;
  limits.points = static_cast<std::uint16_t>(points);
  limits.silhouette = true;
  return limits;
}

/// What a fit is told of besides the points, and tells of them.
struct Work {
  std::uint8_t *is_identity, *is_landmark;
  float *sd, *fit_sd, *weights;
  Vec2* residuals;

  Work(Arena& arena, std::size_t parameters, std::size_t points)
      : is_identity(arena.take<std::uint8_t>(parameters)),
        is_landmark(arena.take<std::uint8_t>(points)),
        sd(arena.take<float>(parameters)),
        fit_sd(arena.take<float>(parameters)),
        weights(arena.take<float>(points)),
        residuals(arena.take<Vec2>(points)) {}
};

}  // namespace

float spread_of(Span<const Correspondence> points) {
  Vec2 low{1e30f, 1e30f}, high{-1e30f, -1e30f};
  for (const Correspondence& c : points) {
    low = {min(low.x, c.x.x), min(low.y, c.x.y)};
    high = {max(high.x, c.x.x), max(high.y, c.x.y)};
  }
  return length(high - low);
}

std::size_t landmark_fit_bytes(const Model& model, std::uint16_t points, Fitter& fitter) {
  Arena trial;
  trial.take<Fitter>(1);
  fitter.lay_out(trial, model, limits_for(points));
  Work(trial, model.parameters().count, points);
  return trial.used_bytes();
}

Status fit_landmarks(Arena& arena, const Model& model, Span<Correspondence> points, const FitOptions& options,
                     float* q, FitReport* report, Vec3* offsets) {
  const float spread = spread_of(points);
  if (!(spread > 0)) return Status::underdetermined;
  void* const room = arena.take<Fitter>(1);
  if (room == nullptr) return Status::out_of_memory;
  Fitter& fitter = *new (room) Fitter();
  Status status = create_in(arena, fitter, model, limits_for(points.count));
  if (status != Status::ok) return status;
  const std::size_t parameters = model.parameters().count;
  const Work work(arena, parameters, points.count);
  if (arena.exhausted()) return Status::out_of_memory;
  for (std::size_t k = 0; k < parameters; ++k) q[k] = 0;
  status = fit_expression_then_identity(model, points, kPointSdShare * spread, options, work.is_identity,
                                        work.fit_sd, work.sd, [&](const FitOptions& stage, float* sd) {
                                          return fitter.fit(points, stage, q, report, sd, work.residuals,
                                                            work.weights);
                                        });
  if (status != Status::ok || offsets == nullptr) return status;
  for (std::size_t i = 0; i < points.count; ++i)
    work.is_landmark[i] = work.weights[i] > 0 && !fitter.has_slid(i);
  Lens lens;
  if (options.camera != nullptr) status = Lens::make(*options.camera, options.width, options.height, &lens);
  place_landmarks(
      model, [&](Vec2 uv) { return fitter.cascade().surface_point(uv, q); }, report->view, lens,
      find_personal(model, points, work.residuals, work.is_landmark, work.sd), offsets);
  return status;
}

}  // namespace pliant
