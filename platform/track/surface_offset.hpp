#pragma once
/// \file surface_offset.hpp
/// A point beside the surface that goes with it: what was given in the picture where the model has no such place, be it
/// that this person has it elsewhere, or that the surface ends before.
#include "pliant/estimator.hpp"

namespace pliant {

/// Offset (mm, model's axes) from the surface point p to what is seen at x (px) in a view. Depth cannot be seen, so that it
/// is taken to be the same: the shortest offset that leads there. It turns with the head, and the surface point below it
/// moves as the expression does. \return false, nothing written: x is not finite, or p behind the camera.
bool find_offset(const View& view, const Lens& lens, Vec3 p, Vec2 x, Vec3* offset);

/// Image position of the surface point at (u,v) with that offset; false behind the camera. With none it is
/// Estimator::project, to the bit.
bool project_beside(Estimator& estimator, Vec2 uv, Vec3 offset, Vec2* x);

}  // namespace pliant
