#include "estimate/lens_transfer.hpp"

namespace pliant {

namespace {

/// M S M^T.
Sym2 transformed(const Mat2& m, Sym2 s) {
  const float ax = m.a * s.xx + m.b * s.xy, ay = m.a * s.xy + m.b * s.yy;
  const float bx = m.c * s.xx + m.d * s.xy, by = m.c * s.xy + m.d * s.yy;
  return {ax * m.a + ay * m.b, ax * m.c + ay * m.d, bx * m.c + by * m.d};
}

Mat2 transposed(const Mat2& m) {
  return {m.a, m.c, m.b, m.d};
}

void transfer(const Lens& lens, Span<Observation> observations, bool distorts) {
  for (Observation& o : observations) {
    if (!is_finite(o.x)) continue;
    const Vec2 pinhole = distorts ? o.x : lens.undistort(o.x);
    Mat2 d;
    const Vec2 seen = lens.distort(pinhole, &d);
    o.x = distorts ? seen : pinhole;
    if (distorts) o.residual = d * o.residual;
    o.information = transformed(transposed(distorts ? inverse(d) : d), o.information);
  }
}

}  // namespace

void distort(const Lens& lens, Prediction* prediction) {
  Mat2 d;
  prediction->x = lens.distort(prediction->x, &d);
  prediction->covariance = transformed(d, prediction->covariance);
  prediction->jacobian = d * prediction->jacobian;
  // A normal transforms with D^-T, so that it stays perpendicular to its edge.
  const Vec2 normal = transposed(inverse(d)) * prediction->normal;
  const float size = length(normal);
  if (size > 0) prediction->normal = (1.0f / size) * normal;
}

void distort(const Lens& lens, Span<Observation> observations) {
  transfer(lens, observations, true);
}

void undistort(const Lens& lens, Span<Observation> observations) {
  transfer(lens, observations, false);
}

}  // namespace pliant
