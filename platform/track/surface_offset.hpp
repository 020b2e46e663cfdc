#pragma once
/// \file surface_offset.hpp
/// Offsets from surface points. A given image position may not lie on the model's surface: this person may
/// have the landmark elsewhere, or the surface may end before it. Such a point is tracked as a surface point
/// and a constant 3D offset.
#include "pliant/estimator.hpp"

namespace pliant {

/// Computes the offset (mm, model's axes) from the surface point p to the image position x (px) in a view.
/// The depth of x is unknown; it is set to that of p, which gives the shortest offset.
/// \return false if x is not finite or p is behind the camera; `offset` is then unchanged.
bool find_offset(const View& view, const Lens& lens, Vec3 p, Vec2 x, Vec3* offset);

/// Where nothing is.
inline constexpr Vec2 kNowhere{-1e6f, -1e6f};

/// Image position (px) in any view of p, or kNowhere behind the camera.
Vec2 place_in(const View& view, const Lens& lens, Vec3 p);

/// Computes the image position of the surface point at (u,v) plus `offset` (mm, model's axes). The offset
/// turns with the head and moves with the surface point. With a zero offset, x is bit for bit that of
/// Estimator::project.
/// \return false if the point is behind the camera.
bool project_beside(Estimator& estimator, Vec2 uv, Vec3 offset, Vec2* x);

}  // namespace pliant
