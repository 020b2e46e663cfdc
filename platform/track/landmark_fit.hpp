#pragma once
/// \file landmark_fit.hpp
/// Who it is, and where: a model fitted to named points of one picture in memory that the tracker will use later.
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/fit.hpp"
#include "pliant/model.hpp"

namespace pliant {

/// Bytes of an arena that fit_landmarks takes for so many points. `fitter` is laid out for measuring: it may be
/// anywhere, a small stack has no room for one.
std::size_t landmark_fit_bytes(const Model& model, std::uint16_t points, Fitter& fitter);

/// Fits pose, person and expression to `points`, whose sd_px is set here; iBUG's jaw is taken as the outline. First
/// what only an expression can explain; then, with that held, who it is. \param q  all parameters, result.
/// \return out_of_memory, and the statuses of Fitter::fit.
Status fit_landmarks(Arena& arena, const Model& model, Span<Correspondence> points, const FitOptions& options,
                     float* q, FitReport* report);

}  // namespace pliant
