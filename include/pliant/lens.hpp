#pragma once
/// \file lens.hpp
/// Lens distortion of points: radial distortion, and pixels that are not square. Images are never resampled: inputs and
/// outputs of fit and estimator are distorted image positions; internally they are undistorted.
#include "pliant/camera.hpp"
#include "pliant/status.hpp"

namespace pliant {

/// With (x,y) = (X/Z, Y/Z), r^2 = x^2 + y^2 and L(r) = 1 + k1 r^2 + k2 r^4 a point is seen at
///   (f L x + cx, aspect f L y + cy).
/// Its ideal position, without lens, is (f x + cx, f y + cy). Beyond the corners of the image the distorted
/// radius continues along its tangent, so the map is one to one on the whole plane (docs/algorithms.md,
/// section 4.5).
class Lens {
 public:
  /// No lens: seen and ideal positions are equal.
  Lens() = default;
  /// \param width, height  image size, px.
  /// \return bad_argument for null, anything not finite, a camera that is not `is_possible` (camera.hpp), an empty image, an aspect
  ///         outside [0.5, 2], or coefficients for which the distorted radius does not grow up to the corners of the image;
  ///         `lens` is then as before.
  static Status make(const Camera& camera, int width, int height, Lens* lens);

  bool is_none() const { return is_none_; }  ///< True without distortion and with square pixels.
  float aspect() const { return camera_.aspect; }  ///< As Camera::aspect.
  /// The lens of a picture whose pixels are square: y is y / aspect of this one's, of the principal point, too.
  Lens of_square_pixels() const;

  /// The seen position of an ideal one, px.
  Vec2 distort(Vec2 ideal) const { return is_none_ ? ideal : distorted(ideal, nullptr); }
  /// The same, with d(seen)/d(ideal).
  Vec2 distort(Vec2 ideal, Mat2* derivative) const { return distorted(ideal, derivative); }
  /// The inverse, by at most 16 steps of Newton's method. Error below 1e-3 px.
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
