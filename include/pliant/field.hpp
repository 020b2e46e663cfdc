#pragma once
/// \file field.hpp
/// Deformation fields: the value of a vector field or a weight field at (u,v) (docs/algorithms.md, section 3.2).
#include <cstdint>

#include "pliant/geometry.hpp"
#include "pliant/model.hpp"

namespace pliant {

/// How a field's value between its samples follows from them. Any table can be read either way.
enum class Interpolation : std::uint8_t {
  /// From 4 samples. Continuous; the gradient jumps across sample lines.
  bilinear = 0,
  /// From 16 samples, by cubic convolution (Catmull-Rom). Passes through the samples, reproduces quadratics, and is
  /// continuously differentiable, also across the rim of a support rectangle inside the chart. Normals of the built-in
  /// face are a third closer to the truth than with `bilinear`. Positions are not, because the baker fits the samples
  /// for bilinear reading. Takes 7 times the instructions of `bilinear` for a value, 4.5 times with the gradient.
  bicubic = 1,
};

/// Value of a field at (u,v), in the field's unit (mm for vectors); zero outside its support. A weight field's value is
/// in x. (u,v) is clamped to [0,1]^2. Cost: that of the interpolation, for each component.
/// \pre `field` is one of `model.fields()`.
Vec3 sample(const Model& model, const Field& field, Vec2 uv,
            Interpolation interpolation = Interpolation::bilinear);

/// The same, with its exact derivatives along u and v. On a sample line a bilinear field has two derivatives;
/// the result is that of the cell with the larger coordinates.
/// \pre `du` and `dv` are not null.
Vec3 sample_with_gradient(const Model& model, const Field& field, Vec2 uv, Vec3* du, Vec3* dv,
                          Interpolation interpolation = Interpolation::bilinear);

}  // namespace pliant
