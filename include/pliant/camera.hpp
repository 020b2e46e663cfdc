#pragma once
/// \file camera.hpp
/// Pinhole camera and rigid pose, and the form of both that the solver works in (docs/algorithms.md, section 4).
#include "pliant/geometry.hpp"

namespace pliant {

/// Intrinsics. Projection is a pinhole: x = f X/Z + cx, y = f Y/Z + cy. lens.hpp adds distortion and pixels
/// that are not square.
struct Camera {
  float f = 0, cx = 0, cy = 0;  ///< focal length and principal point, px
  float k1 = 0, k2 = 0;         ///< radial distortion, OpenCV's first two coefficients
  float aspect = 1;             ///< focal length along y over that along x, 0.5 to 2
};

/// Focal length of an unknown camera over the larger side of its image: 39 degrees of view. Not tuned.
constexpr float kDefaultFocalRatio = 1.4f;

/// The camera of an image with its principal point in the middle, ((W-1)/2, (H-1)/2). f in px.
constexpr Camera centred_camera(int width, int height, float f) {
  return {f, 0.5f * static_cast<float>(width - 1), 0.5f * static_cast<float>(height - 1)};
}

/// Pose and focal length as scaled perspective: with p' = R(q) diag(1,-1,-1) p,
///   x = c + s (p'_xy + tau) / (1 + rho p'_z).
/// It is the pinhole camera with t = (tau, 1/rho) and f = s/rho. The form stays well conditioned when f and
/// depth are not known separately; rho = 0 is weak perspective.
struct View {
  Quat q;             ///< rotation
  float s = 1;        ///< image scale, px per mm
  Vec2 tau;           ///< offset, mm
  float rho = 1e-3f;  ///< perspective strength, 1/mm
  Vec2 c;             ///< principal point, px
};

/// Range of rho: distances between 50 mm and 100 m. It keeps t and f finite.
constexpr float kMinRho = 1e-5f, kMaxRho = 2e-2f;
/// A point with 1 + rho p'_z below this is too near, or behind, the camera.
constexpr float kMinDepthRatio = 0.2f;

/// Smallest and largest focal length of a camera, px.
constexpr float kSmallestFocalPx = 1e-3f, kLargestFocalPx = 1e7f;

/// Whether a pose and a camera can be those of a picture: finite, a distance in the range of rho (up to rounding), a
/// quaternion of length 0.7 to 1.4, a focal length of kSmallestFocalPx to kLargestFocalPx, offsets of at most 10^7 mm and 10^7 px.
bool is_possible(const Pose& pose, const Camera& camera);
/// Conversions between the two forms; rho is clamped to its range.
View view_of(const Pose& pose, const Camera& camera);
Pose pose_of(const View& view);      ///< The pose of a view.
Camera camera_of(const View& view);  ///< The camera of a view, without lens and with square pixels.
/// Towards the camera, in the model's axes; unit. A turn about the optical axis does not change it.
Vec3 camera_direction(const View& view);

/// Unknowns of a view, in the order of the pose block of every solver: rotation increment (rad, applied on the left,
/// in camera axes), log s, tau (mm), log rho. With a known focal length log rho follows log s and is not an unknown.
enum PoseUnknown { kTurnX = 0, kTurnY, kTurnZ, kLogScale, kShiftX, kShiftY, kLogRho };
constexpr int kPoseUnknowns = 6;           ///< with known focal length
constexpr int kPoseUnknownsWithFocal = 7;  ///< with unknown focal length

/// `view` moved by `step`.
/// \param unknowns  kPoseUnknowns (f stays, rho follows s) or kPoseUnknownsWithFocal: values in `step`.
View moved(const View& view, const float* step, int unknowns);

/// A view with its rotation as a matrix. Projects many points.
class Projector {
 public:
  /// \param focal_is_known  whether rho follows s in the derivatives.
  Projector(const View& view, bool focal_is_known);

  /// Image position (px) of a model point (mm).
  /// \return false when the point is too near or behind the camera; x is then unchanged.
  bool project(Vec3 p, Vec2* x) const;
  /// The same of a point in camera axes, as `rotated` gives it.
  bool project_rotated(Vec3 r, Vec2* x) const {
    const float depth = 1 + view_.rho * r.z;
    if (!(depth >= kMinDepthRatio)) return false;
    const float g = view_.s / depth;
    *x = {view_.c.x + g * (r.x + view_.tau.x), view_.c.y + g * (r.y + view_.tau.y)};
    return true;
  }

  /// Derivatives of an image position: `pose[k]` along pose unknown k, `m` (2 x 3, by rows) along the model point.
  struct Derivatives {
    Vec2 pose[kPoseUnknownsWithFocal];  ///< along each pose unknown
    float m[2][3];                      ///< along the model point, by rows
    /// Derivative of the image position along a change d of the model point.
    Vec2 along(Vec3 d) const {
      return {m[0][0] * d.x + m[0][1] * d.y + m[0][2] * d.z, m[1][0] * d.x + m[1][1] * d.y + m[1][2] * d.z};
    }
  };
  /// The same with derivatives: B_i of Eq. 10 is m J_i.
  bool project(Vec3 p, Vec2* x, Derivatives* d) const;

  /// A model direction or point in camera axes, without translation.
  Vec3 rotated(Vec3 p) const { return rotation_ * p; }
  /// p_cam = R diag(1,-1,-1) p + t, t = (tau, 1/rho).
  Vec3 to_camera(Vec3 p) const;

 private:
  View view_;
  Mat3 rotation_;  // R diag(1,-1,-1)
  bool focal_is_known_;
};

}  // namespace pliant
