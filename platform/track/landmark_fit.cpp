#include "landmark_fit.hpp"

#include <new>

namespace pliant {

namespace {

FitLimits limits_for(std::size_t points) {
  FitLimits limits;
  limits.points = static_cast<std::uint16_t>(points);
  limits.outline = true;
  return limits;
}

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
  trial.take<std::uint8_t>(model.parameters().count);
  return trial.used_bytes();
}

Status fit_landmarks(Arena& arena, const Model& model, Span<Correspondence> points, const FitOptions& options,
                     float* q, FitReport* report) {
  const float spread = spread_of(points);
  if (!(spread > 0)) return Status::underdetermined;
  void* const room = arena.take<Fitter>(1);
  if (room == nullptr) return Status::out_of_memory;
  Fitter& fitter = *new (room) Fitter();
  Status status = create_in(arena, fitter, model, limits_for(points.count));
  if (status != Status::ok) return status;
  const auto is_identity = arena.take_span<std::uint8_t>(model.parameters().count);
  if (arena.exhausted()) return Status::out_of_memory;
  for (std::size_t k = 0; k < is_identity.count; ++k) q[k] = 0;
  return fit_expression_then_identity(
      model, points, kPointSdShare * spread, options, is_identity, [&](const FitOptions& stage) {
        return fitter.fit(points, stage, q, report, nullptr, nullptr, nullptr);
      });
}

}  // namespace pliant
