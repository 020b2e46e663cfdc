#include "model/field_step.hpp"

namespace pliant {

namespace {

constexpr Mat3 kIdentity{};

Mat3 blend_with_identity(const Mat3& a, float s) {  // I + s (A - I)
  Mat3 m;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) m.m[i][k] = kIdentity.m[i][k] + s * (a.m[i][k] - kIdentity.m[i][k]);
  return m;
}

/// Smooth ramp: 0 below -h, the identity above h, a parabola between.
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

/// Left Jacobian of the rotation vector w applied to e: d exp(w) along e, as a rotation of the result.
Vec3 left_jacobian(Vec3 w, Vec3 e) {
  const float t2 = dot(w, w);
  float b = 0.5f - t2 / 24, c = 1.0f / 6 - t2 / 120;
  if (t2 > 1e-2f) {
    const Quat q = exp_rotation(w);
    const float s2 = (q.x * q.x + q.y * q.y + q.z * q.z) / t2;  // (sin(t/2)/t)^2
    b = 2 * s2;
    c = (1 - 2 * square_root(s2) * q.w) / t2;
  }
  const Vec3 we = cross(w, e);
  return e + b * we + c * cross(w, we);
}

/// exp([v]x) by Rodrigues' formula, with series that leave 1e-8 for turns of up to 0.5 rad, as jaws make them.
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

/// With `kDerive` all of `out`, else only its p.
template <bool kDerive>
void step(const CascadeRecord& r, const float* q, Vec3 p0, Vec3 p1, Vec3 s, FieldStep& out) {
  const Vec3 pivot{r.pivot[0], r.pivot[1], r.pivot[2]}, axis{r.axis[0], r.axis[1], r.axis[2]};
  const auto value = [&](int k) { return q[r.parameter[k]]; };
  const float w = r.weight == kNone ? 1.0f : s.x;
  switch (r.operation) {
    case Operation::constant:  // Eq. 2, 3
      out.p = s;
      out.keep = 0;
      out.along_field = 1;
      break;
    case Operation::add_vector:  // Eq. 4
      out.p = p0 + value(0) * s;
      out.along_parameter[0] = s;
      out.along_field = value(0);
      break;
    case Operation::product:
      out.p = p0 + (value(0) * value(1)) * s;
      out.along_parameter[0] = value(1) * s;
      out.along_parameter[1] = value(0) * s;
      out.along_field = value(0) * value(1);
      break;
    case Operation::one_sided: {
      float slope;
      out.along_field = ramp(value(0), r.axis[0], &slope);
      out.p = p0 + out.along_field * s;
      out.along_parameter[0] = slope * s;
      break;
    }
    case Operation::scale:
      out.keep = 1 + w * value(0);
      out.p = pivot + out.keep * (p0 - pivot);
      out.along_parameter[0] = w * (p0 - pivot);
      out.along_weight = value(0) * (p0 - pivot);
      break;
    case Operation::rotate: {
      out.map = rotation_by((w * value(0)) * axis);
      out.maps = true;
      const Vec3 arm = out.map * (p0 - pivot);
      out.p = pivot + arm;
      if (!kDerive) break;
      const Vec3 turn = cross(axis, arm);
      out.along_parameter[0] = w * turn;
      out.along_weight = value(0) * turn;
      break;
    }
    case Operation::affine: {
      Mat3 a;
      for (int i = 0; i < 9; ++i) a.m[i / 3][i % 3] = r.matrix[i];
      const Vec3 pull = a * p0 + Vec3{r.matrix[9], r.matrix[10], r.matrix[11]} - p0;
      out.map = blend_with_identity(a, w * value(0));
      out.maps = true;
      out.p = p0 + (w * value(0)) * pull;
      out.along_parameter[0] = w * pull;
      out.along_weight = value(0) * pull;
      break;
    }
    case Operation::rigid: {
      const Vec3 turn{value(0), value(1), value(2)}, move{value(3), value(4), value(5)};
      out.map = rotation_by(w * turn);
      out.maps = true;
      const Vec3 arm = out.map * (p0 - pivot);
      out.p = pivot + arm + w * move;
      if (!kDerive) break;
      const Vec3 unit[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
      for (int k = 0; k < 3; ++k) {
        out.along_parameter[k] = w * cross(left_jacobian(w * turn, unit[k]), arm);
        out.along_parameter[3 + k] = w * unit[k];
      }
      out.along_weight = cross(turn, arm) + move;
      break;
    }
    case Operation::lerp: {
      const float t = w * value(0);
      out.p = (1 - t) * p0 + t * p1;
      out.keep = 1 - t;
      out.keep_second = t;
      out.along_parameter[0] = w * (p1 - p0);
      out.along_weight = value(0) * (p1 - p0);
      break;
    }
  }
}

}  // namespace

FieldStep apply(const CascadeRecord& r, const float* q, Vec3 p0, Vec3 p1, Vec3 s) {
  FieldStep out;
  step<true>(r, q, p0, p1, s, out);
  return out;
}

Vec3 applied(const CascadeRecord& r, const float* q, Vec3 p0, Vec3 p1, Vec3 s) {
  FieldStep out;
  step<false>(r, q, p0, p1, s, out);
  return out.p;
}

bool passes_through_at_zero(const CascadeRecord& r) {
  return r.source[1] == kNone && (r.field != kNone ? r.operation != Operation::constant : r.weight != kNone);
}

bool passes_through(const CascadeRecord& r, const float* q) {
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
    default:
      return q[r.parameter[0]] == 0;
  }
}

}  // namespace pliant
