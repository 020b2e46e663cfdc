#include "landmark_fit.hpp"

#include <new>

namespace pliant {

namespace {

/// How exact a landmark is taken to be, as a share of the points' spread.
constexpr float kPointSdShare = 0.005f;
/// How much further off a landmark must be before a face is taken to make a face.
constexpr float kExpressionCaution = 6;

FitLimits limits_for(std::size_t points) {
  FitLimits limits;
  limits.points = static_cast<std::uint16_t>(points);
  limits.outline = true;
  return limits;
}

float spread_of(Span<const Correspondence> points) {
  Vec2 low{1e30f, 1e30f}, high{-1e30f, -1e30f};
  for (const Correspondence& c : points) {
    low = {min(low.x, c.x.x), min(low.y, c.x.y)};
    high = {max(high.x, c.x.x), max(high.y, c.x.y)};
  }
  return length(high - low);
}

}  // namespace

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
  for (std::size_t k = 0; k < is_identity.count; ++k) {
    is_identity[k] = model.parameters()[k].group == Group::identity;
    q[k] = 0;
  }
  for (Correspondence& c : points) c.sd_px = kExpressionCaution * kPointSdShare * spread;
  status = fitter.fit(points, options, q, report, nullptr, nullptr, nullptr);
  if (status != Status::ok) return status;
  for (Correspondence& c : points) c.sd_px = kPointSdShare * spread;
  FitOptions second = options;
  second.is_free = is_identity.data;
  return fitter.fit(points, second, q, report, nullptr, nullptr, nullptr);
}

}  // namespace pliant
