#pragma once
// One record of the cascade applied at one (u,v) (the paper, Eq. 1-4; docs/algorithms.md, section 3.1).
//
// A record computes a point p = f(p0, p1, s; q) from the points p0 and p1 of its sources, its own sample s at (u,v), and its
// parameters q_k. The sample is a vector V(u,v), or a weight w(u,v) in x. For every operation, FieldStep holds p and the
// partial derivatives of f. All other derivatives follow by the chain rule, where x is any parameter, or u or v:
//
//   dp/dx = (df/dp0) dp0/dx + (df/dp1) dp1/dx + (df/ds) ds/dx + df/dx
//
// - x = q_k gives a column of the Jacobian (Eq. 11); ds/dq_k = 0.
// - x = u or v gives a tangent of the surface; df/dx = 0.
//
// A new operation is one case in field_step.cpp.
#include "pliant/geometry.hpp"
#include "pliant/model.hpp"

namespace pliant {

struct FieldStep {
  Vec3 p;                   ///< f
  Mat3 map;                 ///< df/dp0, where `maps`
  bool maps = false;        ///< whether df/dp0 is `map`; else it is keep * I
  float keep = 1;           ///< df/dp0 / I
  float keep_second = 0;    ///< df/dp1 / I
  Vec3 along_parameter[6];  ///< df/dq_k of the record's own parameters
  float along_field = 0;    ///< df/dV / I
  Vec3 along_weight;        ///< df/dw
};

/// Applies record r to the points of its sources, with its sample s. By reference, since a vector's three floats go into two
/// registers through memory, which then waits for them.
FieldStep apply(const CascadeRecord& r, const float* q, const Vec3& p0, const Vec3& p1, const Vec3& s);
/// p alone: the same bits. Of rotate in half the time.
Vec3 apply_without_derivatives(const CascadeRecord& r, const float* q, const Vec3& p0, const Vec3& p1,
                               const Vec3& s);

/// Whether p = p0 wherever the sample is zero, at any q.
bool keeps_source_at_zero_sample(const CascadeRecord& r);
/// Whether p = p0 at this q, at any (u,v), because parameters are zero.
bool keeps_source(const CascadeRecord& r, const float* q);

}  // namespace pliant
