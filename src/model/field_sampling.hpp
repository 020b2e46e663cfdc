#pragma once
// Reads a field whose samples need not be a table's: a person's folded neutral has its own.
#include "pliant/field.hpp"

namespace pliant {

/// Value of `f` at (u,v) from the samples that start at `samples` (f.first_byte is added). With `du`, also `dv` and the
/// derivatives.
Vec3 sample_field(const std::uint8_t* samples, const Field& f, Vec2 uv, Interpolation interpolation, Vec3* du,
                  Vec3* dv);

}  // namespace pliant
