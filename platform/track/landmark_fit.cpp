#include "track/landmark_fit.hpp"

#include "base/extent.hpp"
#include "base/integers.hpp"
#include "model/ibug_names.hpp"
#include "model/parameters.hpp"
#include "track/offset_landmarks.hpp"

namespace pliant {

float spread_of(Span<const Correspondence> points) {
  Extent extent;
  for (const Correspondence& c : points) extent.include(c.x);
  return length(extent.high - extent.low);
}

bool is_silhouette_landmark(const char* name) {
  if (!is_ibug_landmark(name)) return false;
  name += 4;
  const bool is_below_10 = name[0] == '0' && name[1] >= '0' && name[1] <= '9';
  const bool is_10_to_16 = name[0] == '1' && name[1] >= '0' && name[1] <= '6';
  return (is_below_10 || is_10_to_16) && name[2] == '\0';
}

Camera start_camera(const Camera* known, float focal_px, int width, int height) {
  if (known != nullptr) return *known;
  const float side = static_cast<float>(larger(width, height));
  return centred_camera(width, height, focal_px > 0 ? focal_px : kDefaultFocalRatio * side);
}

void LandmarkFit::lay_out(Arena& arena, const Model& model, std::size_t points, bool samples_base_mesh) {
  FitLimits limits;
  limits.samples_base_mesh = samples_base_mesh;
  limits.points = static_cast<std::uint16_t>(points);
  limits.silhouette = true;
  fitter_.lay_out(arena, model, limits);
  has_identity_ = count_of(Group::identity, model) > 0;
  const std::size_t parameters = model.parameters().count;
  is_identity_ = arena.take<std::uint8_t>(parameters);
  is_landmark_ = arena.take<std::uint8_t>(points);
  sd_ = arena.take<float>(parameters);
  stage_sd_ = arena.take<float>(parameters);
  weights_ = arena.take<float>(points);
  residuals_ = arena.take<Vec2>(points);
}

Status LandmarkFit::fit(Span<Correspondence> points, const FitOptions& options, float* q) {
  if (points.count < kLeastFitPoints) return Status::too_few_points;
  const float spread = spread_of(points);
  if (!(spread >= kLandmarkFitTuning.least_spread_px)) return Status::underdetermined;
  const float sd_px = kLandmarkFitTuning.point_sd_fraction * spread;
  for (Correspondence& c : points) c.sd_px = sd_px;
  if (options.is_free == nullptr && has_identity_) return fit_in_stages(points, options, q);
  return fitter_.fit(points, options, q, &report_, {nullptr, residuals_, weights_, sd_});
}

Status LandmarkFit::fit_in_stages(Span<Correspondence> points, FitOptions options, float* q) {
  const float sd_px = points[0].sd_px;
  for (Correspondence& c : points) c.sd_px = kLandmarkFitTuning.expression_caution * sd_px;
  Status status = fitter_.fit(points, options, q, &report_, {nullptr, residuals_, weights_, sd_});
  if (status != Status::ok) return status;
  for (Correspondence& c : points) c.sd_px = sd_px;
  const Span<const Parameter> parameters = fitter_.cascade().model().parameters();
  for (std::size_t k = 0; k < parameters.count; ++k) is_identity_[k] = parameters[k].group == Group::identity;
  options.is_free = is_identity_;
  status = fitter_.fit(points, options, q, &report_, {nullptr, residuals_, weights_, stage_sd_});
  for (std::size_t k = 0; status == Status::ok && k < parameters.count; ++k)
    if (is_identity_[k] != 0) sd_[k] = stage_sd_[k];
  return status;
}

Span<Correspondence> LandmarkFit::offset_landmarks(Span<Correspondence> points) {
  const float sd_px = kLandmarkFitTuning.annotation_sd_fraction *
                      spread_of(points);  // as the command computes it from a file
  for (Correspondence& c : points) c.sd_px = sd_px;
  for (std::size_t k = 0; k < points.count; ++k) is_landmark_[k] = weights_[k] > 0 && !has_slid(k);
  return find_offset_landmarks(fitter_.cascade().model(), points, residuals_, is_landmark_, sd_);
}

}  // namespace pliant
