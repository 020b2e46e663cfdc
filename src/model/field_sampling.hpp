#pragma once
// Samples a field whose samples need not be in a model's table: a personal field has its own.
#include "pliant/field.hpp"

namespace pliant {

/// A point of the chart, and its mirror image's u.
struct ChartPoint {
  float u, mirrored_u, v;

  explicit ChartPoint(Vec2 uv);
};

/// No value of the field's component c is larger.
inline float largest_value(const Field& f, int c) {
  return magnitude(f.offset[c]) + (f.bits == 16 ? 32768.0f : 128.0f) * magnitude(f.scale[c]);
}

/// Whether the field may differ from zero there.
inline bool is_in_support(const Field& f, const ChartPoint& at) {
  const float u = f.mirror ? at.mirrored_u : at.u;
  return u >= f.u0 && u <= f.u1 && at.v >= f.v0 && at.v <= f.v1;
}

/// Starts to fetch the samples around (u,v), two rows of them.
void prefetch_field(const std::uint8_t* samples, const Field& f, Vec2 uv);

/// Value of `f`, from samples that start at `samples` + f.first_byte. \pre is_in_support(f, at)
Vec3 sample_in_support(const std::uint8_t* samples, const Field& f, const ChartPoint& at,
                       Interpolation interpolation);

/// The same anywhere: zero outside the support.
Vec3 sample_at(const std::uint8_t* samples, const Field& f, const ChartPoint& at,
               Interpolation interpolation);

/// Value and derivatives along u and v. \pre is_in_support(f, at)
Vec3 sample_with_gradient(const std::uint8_t* samples, const Field& f, const ChartPoint& at,
                          Interpolation interpolation, Vec3* du, Vec3* dv);

/// Points of a row of a grid over the chart: those at u = first / steps, (first + 1) / steps, ...
struct ChartRow {
  float v;
  std::size_t first, steps;
};

/// Adds amount * `f` at the points of a row to `sums`: the bits of `sample_at`, in a third of its instructions.
void add_row(const std::uint8_t* samples, const Field& f, float amount, const ChartRow& row,
             Interpolation interpolation, Span<Vec3> sums);

/// Value of `f` at (u,v), from samples that start at `samples` + f.first_byte. With `du`, also the derivatives along u and
/// v, in `du` and `dv`; null for both otherwise.
Vec3 sample_field(const std::uint8_t* samples, const Field& f, Vec2 uv, Interpolation interpolation, Vec3* du,
                  Vec3* dv);

}  // namespace pliant
