#pragma once
// One operation of the cascade applied to one point: its value, how it maps what it is applied to, and its derivatives
// along its own parameters and its own sample. Position, Jacobian (Eq. 11) and surface tangents all follow from these
// by the chain rule, so that a new operation is written once, as one case of `apply`.
#include "pliant/geometry.hpp"
#include "pliant/model.hpp"

namespace pliant {

struct FieldStep {
  Vec3 p;          ///< the result
  Mat3 map;        ///< dp/dp_source; only read when `maps`
  float keep = 1;  ///< otherwise dp/dp_source = keep * I
  bool maps = false;
  float keep_second = 0;    ///< dp/dp of the second source (lerp)
  Vec3 along_parameter[6];  ///< dp/dq of the record's own parameters
  float along_field = 0;    ///< dp/dV = along_field * I
  Vec3 along_weight;        ///< dp/dw
};

/// Applies record r to the points of its sources, p0 and p1, with its sample s (a vector, or a weight in x).
FieldStep apply(const CascadeRecord& r, const float* q, Vec3 p0, Vec3 p1, Vec3 s);
/// The result alone: the same bits, in half the time.
Vec3 applied(const CascadeRecord& r, const float* q, Vec3 p0, Vec3 p1, Vec3 s);

/// True where a record whose sample is zero leaves its source as it is.
bool passes_through_at_zero(const CascadeRecord& r);
/// True where a record leaves its source as it is because its parameters are 0.
bool passes_through(const CascadeRecord& r, const float* q);

}  // namespace pliant
