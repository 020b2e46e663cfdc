#include "track/offset_landmarks.hpp"

namespace pliant {

float person_fraction(float squared_px2, float coordinates, float taken, float sd_px) {
  const float free = coordinates - taken;
  if (!(free > 0)) return 0;
  const float noise = sd_px * sd_px * (free + square_root(2 * free));
  return squared_px2 > noise ? 1 - noise / squared_px2 : 0.0f;
}

float coordinates_taken(const Model& model, const float* sd) {
  float taken = kPoseUnknowns;
  for (std::size_t k = 0; k < model.parameters().count; ++k) {
    const float ratio = sd[k] / model.parameters()[k].sd;
    if (ratio > 0 && ratio < 1) taken += 1 - ratio * ratio;
  }
  return taken;
}

Span<Correspondence> find_offset_landmarks(const Model& model, Span<Correspondence> points,
                                           const Vec2* residuals, const std::uint8_t* is_landmark,
                                           const float* sd) {
  float squared = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < points.count; ++i) {
    if (is_landmark[i] == 0) continue;
    squared += dot(residuals[i], residuals[i]);
    ++count;
  }
  if (count == 0) return {};
  // The fit used all points. The degrees of freedom are divided evenly among them.
  const auto all = static_cast<float>(points.count), these = static_cast<float>(count);
  const float taken = coordinates_taken(model, sd) * these / all;
  const float fraction = person_fraction(squared, 2 * these, taken, points[0].sd_px);
  if (!(fraction > 0)) return {};
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.count; ++i) {
    if (is_landmark[i] == 0) continue;
    points[kept] = points[i];
    points[kept].x = points[i].x + (1 - fraction) * residuals[i];
    ++kept;
  }
  return {points.data, kept};
}

}  // namespace pliant
