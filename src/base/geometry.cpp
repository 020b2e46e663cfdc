#include "pliant/geometry.hpp"

#include <cstdint>
#include <cstring>

namespace pliant {

float square_root(float x) {
  return x <= 0 ? 0.0f : __builtin_sqrtf(x);  // one instruction: no libm to link
}

Vec3 normalised(Vec3 a) {
  const float n = length(a);
  return n > 0 ? (1.0f / n) * a : Vec3{};
}

Quat operator*(Quat a, Quat b) {
  return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
          a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

bool is_finite(float x) {
  std::uint32_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  return (bits & 0x7f800000u) != 0x7f800000u;
}

bool is_finite(Vec2 v) {
  return is_finite(v.x) && is_finite(v.y);
}

bool is_finite(Vec3 v) {
  return is_finite(v.x) && is_finite(v.y) && is_finite(v.z);
}

bool is_finite(const Pose& pose) {
  return is_finite(pose.q.w) && is_finite(pose.q.x) && is_finite(pose.q.y) && is_finite(pose.q.z) &&
         is_finite(pose.t);
}

Mat2 inverse(const Mat2& m) {
  const float det = determinant(m);
  if (det == 0 || !is_finite(det)) return {};
  const float s = 1.0f / det;
  return {s * m.d, -s * m.b, -s * m.c, s * m.a};
}

Quat normalised(Quat q) {
  const float n2 = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
  if (!(n2 > 0) || !is_finite(n2)) return {};
  const float s = (q.w < 0 ? -1.0f : 1.0f) / square_root(n2);
  return {s * q.w, s * q.x, s * q.y, s * q.z};
}

Mat3 rotation_matrix(Quat q) {
  const float xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z, xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z,
              wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
  return {{{1 - 2 * (yy + zz), 2 * (xy - wz), 2 * (xz + wy)},
           {2 * (xy + wz), 1 - 2 * (xx + zz), 2 * (yz - wx)},
           {2 * (xz - wy), 2 * (yz + wx), 1 - 2 * (xx + yy)}}};
}

Quat quaternion(const Mat3& r) {
  // Shepperd's choice of the largest component keeps the division well conditioned.
  const float xx = r.m[0][0], yy = r.m[1][1], zz = r.m[2][2];
  if (xx + yy + zz > 0) {
    const float s = 2 * square_root(1 + xx + yy + zz);
    return normalised(Quat{0.25f * s, (r.m[2][1] - r.m[1][2]) / s, (r.m[0][2] - r.m[2][0]) / s,
                           (r.m[1][0] - r.m[0][1]) / s});
  }
  if (xx >= yy && xx >= zz) {
    const float s = 2 * square_root(1 + xx - yy - zz);
    return normalised(Quat{(r.m[2][1] - r.m[1][2]) / s, 0.25f * s, (r.m[0][1] + r.m[1][0]) / s,
                           (r.m[0][2] + r.m[2][0]) / s});
  }
  if (yy >= zz) {
    const float s = 2 * square_root(1 + yy - xx - zz);
    return normalised(Quat{(r.m[0][2] - r.m[2][0]) / s, (r.m[0][1] + r.m[1][0]) / s, 0.25f * s,
                           (r.m[1][2] + r.m[2][1]) / s});
  }
  const float s = 2 * square_root(1 + zz - xx - yy);
  return normalised(
      Quat{(r.m[1][0] - r.m[0][1]) / s, (r.m[0][2] + r.m[2][0]) / s, (r.m[1][2] + r.m[2][1]) / s, 0.25f * s});
}

Quat exp_rotation(Vec3 w) {
  if (!is_finite(w)) return {};
  int halvings = 0;
  for (; dot(w, w) > 0.25f; ++halvings) w = 0.5f * w;
  // Taylor series of cos(a/2) and sin(a/2)/a in a^2; the next term is below 1e-9 for a <= 0.5.
  const float a2 = dot(w, w);
  const float c = 1 - a2 * (1.0f / 8 - a2 * (1.0f / 384 - a2 * (1.0f / 46080)));
  const float s = 0.5f - a2 * (1.0f / 48 - a2 * (1.0f / 3840 - a2 * (1.0f / 645120)));
  Quat q = normalised(Quat{c, s * w.x, s * w.y, s * w.z});
  for (int k = 0; k < halvings; ++k) q = normalised(q * q);
  return q;
}

Vec3 log_rotation(Quat q) {
  q = normalised(q);
  // Takes square roots of the rotation until its vector part is small, then the series of the arcsine.
  float scale = 2;
  for (int k = 0; k < 6 && q.x * q.x + q.y * q.y + q.z * q.z > 0.01f; ++k) {
    const float half = square_root(0.5f * (1 + q.w));
    const float f = 0.5f / half;
    q = {half, f * q.x, f * q.y, f * q.z};
    scale *= 2;
  }
  const float s2 = q.x * q.x + q.y * q.y + q.z * q.z;
  const float f = scale * (1 + s2 * (1.0f / 6 + s2 * (3.0f / 40 + s2 * (15.0f / 336))));
  return {f * q.x, f * q.y, f * q.z};
}

}  // namespace pliant
