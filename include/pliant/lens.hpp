#pragma once
/// \file lens.hpp
/// What a real lens does to points: radial distortion and pixels that are not square. Points only, never images. Fit and
/// estimator work with an ideal pinhole camera inside; what they are given and give is as seen in the picture.
#include "pliant/camera.hpp"
#include "pliant/status.hpp"

namespace pliant {

/// With (x,y) = (X/Z, Y/Z), r^2 = x^2 + y^2 and L(r) = 1 + k1 r^2 + k2 r^4 a point is seen at
///   (f L x + cx, aspect f L y + cy);
/// ideal is where it would be without: (f x + cx, f y + cy). Beyond the picture's corners the distortion goes on along its
/// tangent, so that the map is one to one on the whole plane.
class Lens {
 public:
  /// None: seen is ideal.
  Lens() = default;
  /// \return bad_argument for anything that is not finite, f <= 0, an aspect outside [0.5, 2], or coefficients for which
  ///         the distorted radius does not grow all the way to the corners of a picture of this size.
  static Status make(const Camera& camera, int width, int height, Lens* lens);

  bool is_none() const { return is_none_; }

  /// Where an ideal point is seen (px).
  Vec2 distort(Vec2 ideal) const { return is_none_ ? ideal : distorted(ideal, nullptr); }
  /// The same, with d(seen)/d(ideal).
  Vec2 distort(Vec2 ideal, Mat2* derivative) const { return distorted(ideal, derivative); }
  /// The inverse, by at most 16 steps of Newton's method: to 1e-3 px.
  Vec2 undistort(Vec2 seen) const { return is_none_ ? seen : undistorted(seen); }

 private:
  Vec2 distorted(Vec2 ideal, Mat2* derivative) const;
  Vec2 undistorted(Vec2 seen) const;
  float radius(float r, float* slope) const;
  float undistorted_radius(float seen) const;

  bool is_none_ = true;
  Camera camera_{1, 0, 0};
  float end_ = 0;                         // the largest r at which L is used
  float end_radius_ = 0, end_slope_ = 1;  // r L(r) and its derivative there
};

}  // namespace pliant
