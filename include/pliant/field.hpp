#pragma once
/// \file field.hpp
/// Deformation fields: sample a vector field at (u,v), and run the cascade to a point and its Jacobian (the paper,
/// section 3; Eq. 1-4, 11).
#include <cstdint>

#include "pliant/geometry.hpp"
#include "pliant/model.hpp"

namespace pliant {

/// Value of a field at (u,v), bilinear, zero outside its support; a weight field's value is in x.
/// (u,v) is clamped to [0,1]^2. Cost: 4 samples.
Vec3 sample(const Model& model, const Field& field, Vec2 uv);

/// The same and its derivatives along u and v (one-sided at sample lines: of the cell that holds (u,v)).
Vec3 sample_with_gradient(const Model& model, const Field& field, Vec2 uv, Vec3* du, Vec3* dv);

/// Surface point F(q,u,v) in millimetres (Eq. 1). `q` holds model.parameters().count values.
Vec3 surface_point(const Model& model, const float* q, Vec2 uv);

/// Surface point and its derivatives along u and v (millimetres per unit of u, v), by the chain rule.
Vec3 surface_tangents(const Model& model, const float* q, Vec2 uv, Vec3* pu, Vec3* pv);

/// Most records a cascade may have.
constexpr std::size_t kMaxRecords = 320;

}  // namespace pliant
