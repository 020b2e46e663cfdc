#pragma once
/// \file geometry.hpp
/// Plain vectors, quaternions and rigid poses. No Eigen here, so that a consumer needs none.
/// All of it is float and uses + - * / and sqrt only, so it gives the same bits on every target.

namespace pliant {

/// A 2-vector: an image position in pixels (x right, y down, pixel centres at integers) or a (u,v) in [0,1]^2.
struct Vec2 {
  float x = 0, y = 0;  ///< components
};

/// A 3-vector, in millimetres unless said otherwise.
struct Vec3 {
  float x = 0, y = 0, z = 0;  ///< components
};

/// A 2 x 2 matrix by rows: [a b; c d].
struct Mat2 {
  float a = 1, b = 0, c = 0, d = 1;  ///< by rows
};

/// A symmetric 2 x 2 matrix: covariance (px^2) or information (1/px^2).
struct Sym2 {
  float xx = 0, xy = 0, yy = 0;  ///< entries
};

/// A 3 x 3 matrix by rows.
struct Mat3 {
  float m[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};  ///< by rows
};

/// A unit quaternion (w,x,y,z); rotates by v' = q v q*.
struct Quat {
  float w = 1, x = 0, y = 0, z = 0;  ///< components
};

/// A rigid pose of the model in camera coordinates (x right, y down, z forward, millimetres):
/// p_cam = R(q) diag(1,-1,-1) p_model + t, so that a frontal face has q = (1,0,0,0).
struct Pose {
  Quat q;              ///< rotation
  Vec3 t{0, 0, 1000};  ///< translation, mm
};

/// A turn that is applied before Pose::q (q becomes q * turn), as a rotation of the model in its own axes.
constexpr Quat in_model_axes(Quat turn) {
  return {turn.w, turn.x, -turn.y, -turn.z};
}

/// Square root, correctly rounded on every target. Negative arguments, which rounding errors make of zeros, give 0. NaN gives NaN:
/// as a 0 it would pass for a distance of nothing, or for certainty.
float square_root(float x);

/// Sum, by components.
constexpr Vec2 operator+(Vec2 a, Vec2 b) {
  return {a.x + b.x, a.y + b.y};
}
/// Difference, by components.
constexpr Vec2 operator-(Vec2 a, Vec2 b) {
  return {a.x - b.x, a.y - b.y};
}
/// Product.
constexpr Vec2 operator*(float s, Vec2 a) {
  return {s * a.x, s * a.y};
}
/// Scalar product.
constexpr float dot(Vec2 a, Vec2 b) {
  return a.x * b.x + a.y * b.y;
}

/// Twice the signed area of a triangle. With y (or v) down, a triangle that is clockwise on the screen has a positive area.
constexpr float doubled_area(Vec2 a, Vec2 b, Vec2 c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Sum, by components.
constexpr Vec3 operator+(Vec3 a, Vec3 b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
/// Difference, by components.
constexpr Vec3 operator-(Vec3 a, Vec3 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
/// Product.
constexpr Vec3 operator*(float s, Vec3 a) {
  return {s * a.x, s * a.y, s * a.z};
}
/// Scalar product.
constexpr float dot(Vec3 a, Vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
/// Vector product.
constexpr Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// Euclidean length.
inline float length(Vec2 a) {
  return square_root(dot(a, a));
}
/// Euclidean length.
inline float length(Vec3 a) {
  return square_root(dot(a, a));
}
/// a / |a|, or zero where |a| is zero or NaN.
Vec3 normalised(Vec3 a);

/// Product.
constexpr Vec2 operator*(const Mat2& m, Vec2 v) {
  return {m.a * v.x + m.b * v.y, m.c * v.x + m.d * v.y};
}
/// Product.
constexpr Mat2 operator*(const Mat2& l, const Mat2& r) {
  return {l.a * r.a + l.b * r.c, l.a * r.b + l.b * r.d, l.c * r.a + l.d * r.c, l.c * r.b + l.d * r.d};
}
/// Determinant.
constexpr float determinant(const Mat2& m) {
  return m.a * m.d - m.b * m.c;
}
/// Inverse of m; the identity where the determinant is zero or not finite.
Mat2 inverse(const Mat2& m);

/// Product.
constexpr Vec3 operator*(const Mat3& m, Vec3 v) {
  return {m.m[0][0] * v.x + m.m[0][1] * v.y + m.m[0][2] * v.z,
          m.m[1][0] * v.x + m.m[1][1] * v.y + m.m[1][2] * v.z,
          m.m[2][0] * v.x + m.m[2][1] * v.y + m.m[2][2] * v.z};
}

/// Hamilton product: rotate by b first, then by a.
Quat operator*(Quat a, Quat b);
/// The inverse rotation of a unit quaternion.
constexpr Quat conjugate(Quat q) {
  return {q.w, -q.x, -q.y, -q.z};
}
/// q / |q|, with w >= 0; the identity where |q| is zero or not finite.
Quat normalised(Quat q);
/// Rotation matrix of a unit quaternion.
Mat3 rotation_matrix(Quat q);
/// Unit quaternion of a rotation matrix.
Quat quaternion(const Mat3& rotation);
/// Unit quaternion of the rotation vector w (axis times angle, radians), by Taylor series without sin or cos: exact to 1e-7 for
/// |w| <= 0.5 rad; larger angles are halved until they are below and the result squared.
Quat exp_rotation(Vec3 w);
/// Rotation vector of q (shortest way), radians; inverse of exp_rotation to 1e-6.
Vec3 log_rotation(Quat q);

bool is_finite(float x);           ///< True for neither NaN nor infinity.
bool is_finite(Vec2 v);            ///< True where no component is NaN or infinite.
bool is_finite(Vec3 v);            ///< True where no component is NaN or infinite.
bool is_finite(const Pose& pose);  ///< True where no component is NaN or infinite.

/// The smaller one; a if one of them is NaN.
constexpr float min(float a, float b) {
  return b < a ? b : a;
}
/// The larger one; a if one of them is NaN.
constexpr float max(float a, float b) {
  return a < b ? b : a;
}
/// The smaller one of each component.
constexpr Vec2 min(Vec2 a, Vec2 b) {
  return {min(a.x, b.x), min(a.y, b.y)};
}
/// The larger one of each component.
constexpr Vec2 max(Vec2 a, Vec2 b) {
  return {max(a.x, b.x), max(a.y, b.y)};
}
/// The smaller one of each component.
constexpr Vec3 min(Vec3 a, Vec3 b) {
  return {min(a.x, b.x), min(a.y, b.y), min(a.z, b.z)};
}
/// The larger one of each component.
constexpr Vec3 max(Vec3 a, Vec3 b) {
  return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)};
}
/// x, or the nearer end of [lo, hi].
constexpr float clamp(float x, float lo, float hi) {
  return x < lo ? lo : (hi < x ? hi : x);
}
/// Absolute value.
constexpr float magnitude(float x) {
  return x < 0 ? -x : x;
}

}  // namespace pliant
