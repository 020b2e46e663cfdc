#pragma once
/// \file personal_landmarks.hpp
/// Landmarks of the person, not of the model: nobody's lip border or brow is just where a model of all people has it, so
/// that a fit leaves offsets at the points it was given, which a track would carry along as an error that never goes.
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/fit.hpp"
#include "pliant/lens.hpp"
#include "pliant/model.hpp"
#include "track/surface_offset.hpp"

namespace pliant {

/// m^2 / (m^2 + s^2): how much of the residuals of a fit is the person's, m, and not noise of the points, s. Empirical
/// Bayes: m^2 + s^2 is the mean square of a residual's coordinate, where those are counted that the fit has left free, n of
/// them. Noise alone leaves a sum of s^2 (n +- sqrt(2 n)), and as much as the upper end is taken to be noise. 0 when that
/// explains the residuals, or nothing is left free.
/// \param squared_px2  sum of the squared residuals; \param coordinates  how many coordinates it is of;
/// \param taken        of those taken by the fit (trace of its hat matrix).
float person_share(float squared_px2, float coordinates, float taken, float sd_px);

/// What a fit has taken of its points' coordinates: the pose, and of each parameter 1 - (sd / prior's sd)^2, which for
/// linear least squares with such priors is the hat matrix's trace. \param sd  after the fit; 0: not fitted.
float coordinates_taken(const Model& model, const float* sd);

/// Where the person has the landmarks that were given. Those of `points` move to the front of it whose flag in
/// `is_landmark` is set; their x moves from the given towards the model's place by the share that is noise. Returned is
/// that front part, empty where the model's own landmarks are as good.
/// \param points     of a fit: given places, all with the same sd; \param residuals  projected minus given, px.
/// \param is_landmark  whether the point was used, and at its own place, not slid along the outline.
Span<Correspondence> find_personal(const Model& model, Span<Correspondence> points, const Vec2* residuals,
                                   const std::uint8_t* is_landmark, const float* sd);

/// Offsets (mm) of all of the model's landmarks in the view in which `personal` was found; 0 for others. A landmark with
/// another's (u,v) goes with it. \param surface_point  (u,v) -> mm, of what is going to be tracked: a person folded to a
/// coarser grid is not quite where it was fitted. \param offsets  a landmark each.
template <class Surface>
void place_landmarks(const Model& model, Surface&& surface_point, const View& view, const Lens& lens,
                     Span<const Correspondence> personal, Vec3* offsets) {
  const auto landmarks = model.landmarks();
  for (std::size_t k = 0; k < landmarks.count; ++k) {
    offsets[k] = {};
    for (const Correspondence& c : personal)
      if (c.uv.x == landmarks[k].u && c.uv.y == landmarks[k].v)
        find_offset(view, lens, surface_point(c.uv), c.x, &offsets[k]);
  }
}

}  // namespace pliant
