#pragma once
// Samples a field whose samples need not be in a model's table: a personal field has its own.
#include "pliant/field.hpp"

namespace pliant {

/// Value of `f` at (u,v), from samples that start at `samples` + f.first_byte. With `du`, also the derivatives along u and
/// v, in `du` and `dv`; null for both otherwise.
Vec3 sample_field(const std::uint8_t* samples, const Field& f, Vec2 uv, Interpolation interpolation, Vec3* du,
                  Vec3* dv);

}  // namespace pliant
