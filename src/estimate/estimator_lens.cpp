// The door between the estimator's pinhole and the picture as the lens makes it: points, and with the lens's derivative D
// at the point everything that is measured in pixels around it.
#include "pliant/estimator.hpp"

namespace pliant {

namespace {

/// M S M^T.
Sym2 carried(const Mat2& m, Sym2 s) {
  const float ax = m.a * s.xx + m.b * s.xy, ay = m.a * s.xy + m.b * s.yy;
  const float bx = m.c * s.xx + m.d * s.xy, by = m.c * s.xy + m.d * s.yy;
  return {ax * m.a + ay * m.b, ax * m.c + ay * m.d, bx * m.c + by * m.d};
}

Mat2 transposed(const Mat2& m) {
  return {m.a, m.c, m.b, m.d};
}

}  // namespace

void Estimator::see_through_lens(Prediction* p) const {
  Mat2 d;
  p->x = lens_.distort(p->x, &d);
  p->covariance = carried(d, p->covariance);
  p->jacobian = d * p->jacobian;
  // Normals go with the inverse transposed: what is across an edge stays across it.
  const Vec2 normal = transposed(inverse(d)) * p->normal;
  const float size = length(normal);
  if (size > 0) p->normal = (1.0f / size) * normal;
}

/// Observations as the pinhole would have made them: information goes with D^T W D.
void Estimator::undistort(Span<Observation> observations) const {
  for (Observation& o : observations) {
    if (!is_finite(o.x)) continue;
    o.x = lens_.undistort(o.x);
    Mat2 d;
    lens_.distort(o.x, &d);
    o.information = carried(transposed(d), o.information);
  }
}

void Estimator::distort(Span<Observation> observations) const {
  for (Observation& o : observations) {
    if (!is_finite(o.x)) continue;
    Mat2 d;
    o.x = lens_.distort(o.x, &d);
    o.information = carried(transposed(inverse(d)), o.information);
  }
}

}  // namespace pliant
