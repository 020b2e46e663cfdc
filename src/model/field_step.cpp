#include "model/field_step.hpp"

namespace pliant {

namespace {

constexpr Mat3 kIdentity{};

/// I + s (A - I)
Mat3 blend_with_identity(const Mat3& a, float s) {
  Mat3 m;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) m.m[i][k] = kIdentity.m[i][k] + s * (a.m[i][k] - kIdentity.m[i][k]);
  return m;
}

/// phi(x): 0 for x <= -h, x for x >= h, and between them the parabola (x + h)^2 / 4h, which joins both with their slopes.
float ramp(float x, float h, float* slope) {
  if (x <= -h) {
    *slope = 0;
    return 0;
  }
  if (x >= h) {
    *slope = 1;
    return x;
  }
  *slope = (x + h) / (2 * h);
  return (x + h) * (x + h) / (4 * h);
}

/// J_l(w) e = e + b w x e + c w x (w x e), b = (1 - cos t) / t^2, c = (t - sin t) / t^3, t = |w|. Turning the vector w by
/// a small d along e turns exp(w) by the rotation vector d J_l(w) e, applied after it.
Vec3 left_jacobian(Vec3 w, Vec3 e) {
  const float t2 = dot(w, w);
  float b = 0.5f - t2 / 24, c = 1.0f / 6 - t2 / 120;
  if (t2 > 1e-2f) {
    const Quat q = exp_rotation(w);
    const float half = (q.x * w.x + q.y * w.y + q.z * w.z) / t2;  // sin(t/2) / t, with the sign of q
    b = 2 * half * half;
    c = (1 - 2 * half * q.w) / t2;
  }
  const Vec3 we = cross(w, e);
  return e + b * we + c * cross(w, we);
}

/// R(v) = exp([v]x) = I + s [v]x + c [v]x^2, s = sin a / a, c = (1 - cos a) / a^2, a = |v| (Rodrigues). Up to 0.5 rad,
/// which covers a jaw, s and c come from their Taylor series, with an error below 1e-8.
Mat3 rotation_by(Vec3 v) {
  const float a2 = dot(v, v);
  if (!(a2 <= 0.25f)) return rotation_matrix(exp_rotation(v));
  const float s = 1 - a2 * (1.0f / 6 - a2 * (1.0f / 120 - a2 * (1.0f / 5040)));
  const float c = 0.5f - a2 * (1.0f / 24 - a2 * (1.0f / 720 - a2 * (1.0f / 40320)));
  const float xy = c * v.x * v.y, xz = c * v.x * v.z, yz = c * v.y * v.z;
  const float x = s * v.x, y = s * v.y, z = s * v.z;
  const float xx = c * v.x * v.x, yy = c * v.y * v.y, zz = c * v.z * v.z;
  return {{{1 - yy - zz, xy - z, xz + y}, {xy + z, 1 - xx - zz, yz - x}, {xz - y, yz + x, 1 - xx - yy}}};
}

/// What a record reads.
struct Operands {
  const CascadeRecord& r;
  const float* q;
  const Vec3 &p0, &p1, &s;

  float parameter(int k) const { return q[r.parameter[k]]; }
  float w() const { return r.weight == kNone ? 1.0f : s.x; }
  Vec3 axis() const { return {r.axis[0], r.axis[1], r.axis[2]}; }
  Vec3 pivot() const { return {r.pivot[0], r.pivot[1], r.pivot[2]}; }
  // About the axis. Zero at most points of a face: away from the jaw.
  float angle() const { return w() * parameter(0); }
  Mat3 rotation() const { return rotation_by(angle() * axis()); }
};

/// The derivatives of p0 + w q d by q and by w.
inline void derive(const Operands& o, Vec3 d, FieldStep& out) {
  out.along_parameter[0] = o.w() * d;
  out.along_weight = o.parameter(0) * d;
}

/// p = V (Eq. 2, 3)
void constant(const Operands& o, FieldStep& out) {
  out.p = o.s;
  out.keep = 0;
  out.along_field = 1;
}

/// p = p0 + q V (Eq. 4)
void add_vector(const Operands& o, FieldStep& out) {
  const float q = o.parameter(0);
  out.p = o.p0 + q * o.s;
  out.along_parameter[0] = o.s;
  out.along_field = q;
}

/// p = p0 + q_a q_b V
void product(const Operands& o, FieldStep& out) {
  const float a = o.parameter(0), b = o.parameter(1);
  out.p = o.p0 + (a * b) * o.s;
  out.along_parameter[0] = b * o.s;
  out.along_parameter[1] = a * o.s;
  out.along_field = a * b;
}

/// p = p0 + phi(q) V
void one_sided(const Operands& o, FieldStep& out) {
  float slope;
  out.along_field = ramp(o.parameter(0), o.r.axis[0], &slope);
  out.p = o.p0 + out.along_field * o.s;
  out.along_parameter[0] = slope * o.s;
}

/// p = c + (1 + w q) (p0 - c)
void scale(const Operands& o, FieldStep& out) {
  const float q = o.parameter(0), w = o.w();
  const Vec3 arm = o.p0 - o.pivot();
  out.keep = 1 + w * q;
  out.p = o.pivot() + out.keep * arm;
  derive(o, arm, out);
}

/// p = c + R(w q a) (p0 - c), a the axis. A small turn d about a moves p by d a x (p - c).
void rotate(const Operands& o, FieldStep& out) {
  out.maps = o.angle() != 0;
  if (out.maps) out.map = o.rotation();
  const Vec3 from = o.p0 - o.pivot(), arm = out.maps ? out.map * from : from;
  out.p = o.pivot() + arm;
  derive(o, cross(o.axis(), arm), out);
}

/// p = p0 + w q (A p0 + b - p0)
void affine(const Operands& o, FieldStep& out) {
  const float q = o.parameter(0), w = o.w();
  Mat3 a;
  for (int i = 0; i < 9; ++i) a.m[i / 3][i % 3] = o.r.matrix[i];
  const Vec3 pull = a * o.p0 + Vec3{o.r.matrix[9], o.r.matrix[10], o.r.matrix[11]} - o.p0;
  out.map = blend_with_identity(a, w * q);
  out.maps = true;
  out.p = o.p0 + (w * q) * pull;
  derive(o, pull, out);
}

/// p = c + R(w r) (p0 - c) + w t, with the rotation vector r = (q_0, q_1, q_2) and the translation t = (q_3, q_4, q_5)
void rigid(const Operands& o, FieldStep& out) {
  const Vec3 turn{o.parameter(0), o.parameter(1), o.parameter(2)};
  const Vec3 move{o.parameter(3), o.parameter(4), o.parameter(5)}, pivot = o.pivot();
  const float w = o.w();
  out.map = rotation_by(w * turn);
  out.maps = true;
  const Vec3 arm = out.map * (o.p0 - pivot);
  out.p = pivot + arm + w * move;
  const Vec3 unit[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int k = 0; k < 3; ++k) {
    out.along_parameter[k] = w * cross(left_jacobian(w * turn, unit[k]), arm);
    out.along_parameter[3 + k] = w * unit[k];
  }
  out.along_weight = cross(turn, arm) + move;
}

/// p = (1 - w q) p0 + w q p1
void lerp(const Operands& o, FieldStep& out) {
  const float q = o.parameter(0), w = o.w(), t = w * q;
  out.p = (1 - t) * o.p0 + t * o.p1;
  out.keep = 1 - t;
  out.keep_second = t;
  derive(o, o.p1 - o.p0, out);
}

}  // namespace

FieldStep apply(const CascadeRecord& r, const float* q, const Vec3& p0, const Vec3& p1, const Vec3& s) {
  FieldStep out;
  const Operands o{r, q, p0, p1, s};
  switch (r.operation) {
    case Operation::constant:
      constant(o, out);
      break;
    case Operation::add_vector:
      add_vector(o, out);
      break;
    case Operation::product:
      product(o, out);
      break;
    case Operation::one_sided:
      one_sided(o, out);
      break;
    case Operation::scale:
      scale(o, out);
      break;
    case Operation::rotate:
      rotate(o, out);
      break;
    case Operation::affine:
      affine(o, out);
      break;
    case Operation::rigid:
      rigid(o, out);
      break;
    case Operation::lerp:
      lerp(o, out);
      break;
  }
  return out;
}

/// Only what runs at every vertex, or is most of a cascade, is worth code of its own.
Vec3 apply_without_derivatives(const CascadeRecord& r, const float* q, const Vec3& p0, const Vec3& p1,
                               const Vec3& s) {
  if (r.operation == Operation::add_vector) return p0 + q[r.parameter[0]] * s;
  if (r.operation != Operation::rotate) return apply(r, q, p0, p1, s).p;
  const Operands o{r, q, p0, p1, s};
  const Vec3 arm = p0 - o.pivot();
  return o.pivot() + (o.angle() != 0 ? o.rotation() * arm : arm);
}

bool keeps_source_at_zero_sample(const CascadeRecord& r) {
  return r.source[1] == kNone && (r.field != kNone ? r.operation != Operation::constant : r.weight != kNone);
}

bool keeps_source(const CascadeRecord& r, const float* q) {
  switch (r.operation) {
    case Operation::constant:
    case Operation::one_sided:
    case Operation::lerp:
      return false;
    case Operation::product:
      return q[r.parameter[0]] * q[r.parameter[1]] == 0;
    case Operation::rigid:
      for (std::uint16_t p : r.parameter)
        if (q[p] != 0) return false;
      return true;
    case Operation::add_vector:
    case Operation::scale:
    case Operation::rotate:
    case Operation::affine:
      return q[r.parameter[0]] == 0;
  }
  return false;
}

}  // namespace pliant
