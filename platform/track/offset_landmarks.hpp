#pragma once
/// \file offset_landmarks.hpp
/// Landmarks as this person has them. A model of many people does not have every person's lip border or brow
/// at the right place, so residuals remain after a fit. A track would repeat them as a constant error in
/// every frame.
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/fit.hpp"
#include "pliant/model.hpp"

namespace pliant {

/// Fraction of the residuals' mean square that is due to the person, 0..1: m^2 / (m^2 + s^2), where m is the
/// standard deviation of the person's deviation from the model and s that of the points' noise (empirical
/// Bayes). The fit leaves n = coordinates - taken degrees of freedom. Noise alone gives a sum of squares of
/// s^2 (n +- sqrt(2 n)); the upper end of this range counts as noise. Returns 0 if noise explains the
/// residuals, or if n <= 0.
/// \param squared_px2  sum of the squared residuals; \param coordinates  number of coordinates in that sum;
/// \param taken        degrees of freedom that the fit has used (trace of its hat matrix); \param sd_px  s.
float person_fraction(float squared_px2, float coordinates, float taken, float sd_px);

/// Degrees of freedom that a fit has used: those of the pose, and 1 - (sd / sd of the prior)^2 for each parameter. For
/// linear least squares with Gaussian priors this is the trace of the hat matrix.
/// \param sd  FitDetails::point_sd of each parameter; 0 if it was not fitted.
float coordinates_taken(const Model& model, const float* sd);

/// Finds where this person has the given landmarks. The points whose flag in `is_landmark` is set are moved
/// to the front of `points`. The position x of each moves from the given position towards the model's, by the
/// fraction that is noise. Returns that front part; it is empty if noise explains all residuals.
/// \param points       of a fit: given positions, all with the same sd.
/// \param residuals    projected minus given, px, one a point.
/// \param is_landmark  1 if the fit used the point and did not move it along the silhouette.
/// \param sd           FitDetails::point_sd of each parameter.
Span<Correspondence> find_offset_landmarks(const Model& model, Span<Correspondence> points,
                                           const Vec2* residuals, const std::uint8_t* is_landmark,
                                           const float* sd);

}  // namespace pliant
