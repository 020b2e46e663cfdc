#pragma once
// Conversion of predictions and observations between the pinhole image, in which the estimator works, and the image
// behind the lens, which the caller sees. D is the derivative of the distortion at the point.
#include "pliant/arena.hpp"
#include "pliant/lens.hpp"
#include "pliant/observation.hpp"

namespace pliant {

/// Position, covariance (D C D^T), Jacobian (D J) and normal of a prediction, from pinhole to lens.
void distort(const Lens& lens, Prediction* prediction);
/// Position, residual (D r) and information (D^-T W D^-1) of observations, from pinhole to lens. Those whose positions are not
/// finite are left.
void distort(const Lens& lens, Span<Observation> observations);
/// The inverse of `distort` but for the residual, which is a solve's result: information becomes D^T W D.
void undistort(const Lens& lens, Span<Observation> observations);

}  // namespace pliant
