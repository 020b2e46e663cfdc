#pragma once
// Samples a field whose samples need not be in a model's table: a personal field has its own.
#include "pliant/field.hpp"

namespace pliant {

/// Whether the field may differ from zero at (u,v).
inline bool is_in_support(const Field& f, Vec2 uv) {
  const float right = clamp(uv.x, 0, 1), u = f.mirror ? 1 - right : right, v = clamp(uv.y, 0, 1);
  return u >= f.u0 && u <= f.u1 && v >= f.v0 && v <= f.v1;
}

/// Value of `f` at (u,v), from samples that start at `samples` + f.first_byte. With `du`, also the derivatives along u and
/// v, in `du` and `dv`; null for both otherwise.
Vec3 sample_field(const std::uint8_t* samples, const Field& f, Vec2 uv, Interpolation interpolation, Vec3* du,
                  Vec3* dv);

}  // namespace pliant
