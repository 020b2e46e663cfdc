#pragma once
/// \file landmark_fit.hpp
/// Who it is, and where: a model fitted to named points of one picture in memory that the tracker will use later.
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/fit.hpp"
#include "pliant/model.hpp"

namespace pliant {

/// How exact a landmark is taken to be, as a share of the points' spread: people and detectors err with the size of the
/// face, not with the size of the picture.
constexpr float kPointSdShare = 0.005f;
/// How much further off a landmark must be before a face is taken to make a face: that a person's lips are thinner
/// than the model's, or a landmark annotated elsewhere, is no expression.
constexpr float kExpressionCaution = 6;

/// Diagonal of the points' box, px; of no points not a number to use.
float spread_of(Span<const Correspondence> points);

/// First what only an expression can explain; then, with that held, who it is. `fit(options, sd)` is called twice and fits
/// all of `points`, whose sd_px is set here to `sd_px` in the end. \param sd  deviation a parameter, each of the fit that
/// has estimated it. \param is_identity, fit_sd  room for a flag and a deviation a parameter.
template <class Fit>
Status fit_expression_then_identity(const Model& model, Span<Correspondence> points, float sd_px,
                                    FitOptions options, std::uint8_t* is_identity, float* fit_sd, float* sd,
                                    Fit&& fit) {
  const std::size_t parameters = model.parameters().count;
  for (Correspondence& c : points) c.sd_px = kExpressionCaution * sd_px;
  Status status = fit(options, sd);
  if (status != Status::ok) return status;
  for (Correspondence& c : points) c.sd_px = sd_px;
  for (std::size_t k = 0; k < parameters; ++k)
    is_identity[k] = model.parameters()[k].group == Group::identity;
  options.is_free = is_identity;
  status = fit(options, fit_sd);
  for (std::size_t k = 0; status == Status::ok && k < parameters; ++k)
    if (is_identity[k] != 0) sd[k] = fit_sd[k];
  return status;
}

/// Bytes of an arena that fit_landmarks takes for so many points. `fitter` is laid out for measuring: it may be
/// anywhere, a small stack has no room for one.
std::size_t landmark_fit_bytes(const Model& model, std::uint16_t points, Fitter& fitter);

/// Fits pose, person and expression to `points`, whose sd_px is set here; iBUG's jaw is taken as the outline. First
/// the expression, then the identity, as above. \param q  all parameters, result.
/// \param offsets  where the person has the landmarks (place_landmarks): one for each of the model's; `points` is
/// rearranged. Null: not asked for.
/// \return out_of_memory, and the statuses of Fitter::fit.
Status fit_landmarks(Arena& arena, const Model& model, Span<Correspondence> points, const FitOptions& options,
                     float* q, FitReport* report, Vec3* offsets = nullptr);

}  // namespace pliant
