#pragma once
// Fields and cascades in double precision, written from their definitions and not from the library's code: what it is
// compared with.
#include <Eigen/Dense>
#include <algorithm>
#include <cstring>
#include <vector>

#include "pliant/cascade.hpp"

namespace reference {

using Vec = Eigen::Vector3d;

inline Vec of(pliant::Vec3 v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

/// Value of the cubic through s0 and s1 whose slopes are half the differences of their neighbours.
inline double catmull_rom(double a, double before, double s0, double s1, double after) {
  const double m0 = (s1 - before) / 2, m1 = (after - s0) / 2;
  return (1 + 2 * a) * (1 - a) * (1 - a) * s0 + a * (1 - a) * (1 - a) * m0 + a * a * (3 - 2 * a) * s1 +
         a * a * (a - 1) * m1;
}

class Field {
 public:
  Field(const pliant::Model& model, const pliant::Field& f, pliant::Interpolation how)
      : model_(model), f_(f), cubic_(how == pliant::Interpolation::bicubic) {}

  Vec at(double u, double v) const {
    u = std::clamp(u, 0.0, 1.0);
    v = std::clamp(v, 0.0, 1.0);
    if (f_.mirror) u = 1 - u;
    const double x = (u - real(f_.u0)) / (real(f_.u1) - real(f_.u0)) * (f_.width - 1),
                 y = (v - real(f_.v0)) / (real(f_.v1) - real(f_.v0)) * (f_.height - 1);
    if (x < 0 || y < 0 || x > f_.width - 1 || y > f_.height - 1) return Vec::Zero();
    const int i = std::min(static_cast<int>(x), f_.width - 2),
              j = std::min(static_cast<int>(y), f_.height - 2);
    Vec p = Vec::Zero();
    for (int c = 0; c < f_.components; ++c) {
      double row[4];
      for (int l = -1; l <= 2; ++l) row[l + 1] = along_row(i, j + l, x - i, c);
      const double b = y - j;
      p[c] = cubic_ ? catmull_rom(b, row[0], row[1], row[2], row[3]) : (1 - b) * row[1] + b * row[2];
    }
    if (f_.mirror && f_.components == 3) p[0] = -p[0];
    return p;
  }

 private:
  static double real(float x) { return static_cast<double>(x); }

  double along_row(int i, int j, double a, int c) const {
    const auto s = [&](int k) { return beyond_rows(i + k, j, c); };
    return cubic_ ? catmull_rom(a, s(-1), s(0), s(1), s(2)) : (1 - a) * s(0) + a * s(1);
  }

  /// A sample one row or column beyond the rim: by the parabola through three on the border of the chart, by
  /// reflection on a rim inside it.
  double beyond_rows(int i, int j, int c) const {
    if (j < 0) return continued(f_.v0 > 0, f_.height, [&](int k) { return beyond_columns(i, k, c); });
    if (j >= f_.height)
      return continued(f_.v1 < 1, f_.height, [&](int k) { return beyond_columns(i, f_.height - 1 - k, c); });
    return beyond_columns(i, j, c);
  }
  double beyond_columns(int i, int j, int c) const {
    if (i < 0) return continued(f_.u0 > 0, f_.width, [&](int k) { return stored(k, j, c); });
    if (i >= f_.width)
      return continued(f_.u1 < 1, f_.width, [&](int k) { return stored(f_.width - 1 - k, j, c); });
    return stored(i, j, c);
  }
  template <class Sample>
  static double continued(bool is_rim, int count, const Sample& s) {
    if (is_rim) return s(1);
    return count == 2 ? 2 * s(0) - s(1) : 3 * s(0) - 3 * s(1) + s(2);
  }

  double stored(int i, int j, int c) const {
    const auto k = static_cast<std::size_t>((j * f_.width + i) * f_.components + c);
    const std::uint8_t* p = model_.samples() + f_.first_byte + k * (f_.bits / 8u);
    std::int16_t wide = static_cast<std::int8_t>(*p);
    if (f_.bits == 16) std::memcpy(&wide, p, 2);
    return real(f_.offset[c]) + real(f_.scale[c]) * wide;
  }

  const pliant::Model& model_;
  const pliant::Field& f_;
  bool cubic_;
};

inline Eigen::Matrix3d rotation(const Vec& w) {
  return w.norm() == 0 ? Eigen::Matrix3d::Identity()
                       : Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix();
}

/// Result of one record, by the table of operations in model.hpp.
inline Vec apply(const pliant::CascadeRecord& r, const std::vector<double>& q, const Vec& p, const Vec& p1,
                 const Vec& field, double w) {
  using pliant::Operation;
  const auto value = [&](int k) { return q[r.parameter[k]]; };
  const Vec c(static_cast<double>(r.pivot[0]), static_cast<double>(r.pivot[1]),
              static_cast<double>(r.pivot[2]));
  const Vec axis(static_cast<double>(r.axis[0]), static_cast<double>(r.axis[1]),
                 static_cast<double>(r.axis[2]));
  switch (r.operation) {
    case Operation::constant:
      return field;
    case Operation::add_vector:
      return p + value(0) * field;
    case Operation::product:
      return p + value(0) * value(1) * field;
    case Operation::one_sided: {
      const double h = axis[0], x = value(0);
      return p + (x <= -h ? 0 : x >= h ? x : (x + h) * (x + h) / (4 * h)) * field;
    }
    case Operation::scale:
      return c + (1 + w * value(0)) * (p - c);
    case Operation::rotate:
      return c + rotation(w * value(0) * axis) * (p - c);
    case Operation::affine: {
      Eigen::Matrix3d a;
      for (int i = 0; i < 9; ++i) a(i / 3, i % 3) = static_cast<double>(r.matrix[i]);
      const Vec b(static_cast<double>(r.matrix[9]), static_cast<double>(r.matrix[10]),
                  static_cast<double>(r.matrix[11]));
      return p + w * value(0) * (a * p + b - p);
    }
    case Operation::rigid:
      return c + rotation(w * Vec(value(0), value(1), value(2))) * (p - c) +
             w * Vec(value(3), value(4), value(5));
    case Operation::lerp:
      return (1 - w * value(0)) * p + w * value(0) * p1;
  }
  return Vec::Zero();
}

/// The surface point. `scale`, if asked for, becomes the largest coordinate on the way.
inline Vec surface_point(const pliant::Model& model, double u, double v, const std::vector<double>& q,
                         pliant::Interpolation how = pliant::Interpolation::bilinear,
                         double* scale = nullptr) {
  std::vector<Vec> value;
  for (const pliant::CascadeRecord& r : model.cascade()) {
    const auto source = [&](int k) {
      return r.source[k] == pliant::kNone ? Vec(Vec::Zero()) : value[r.source[k]];
    };
    const auto sampled = [&](std::uint16_t f) { return Field(model, model.fields()[f], how).at(u, v); };
    const Vec field = r.field == pliant::kNone ? Vec(Vec::Zero()) : sampled(r.field);
    const double w = r.weight == pliant::kNone ? 1 : sampled(r.weight)[0];
    value.push_back(apply(r, q, source(0), source(1), field, w));
    if (scale != nullptr) *scale = std::max(*scale, value.back().cwiseAbs().maxCoeff());
  }
  return value.back();
}

}  // namespace reference
