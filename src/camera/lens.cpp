// Radial distortion (Brown's polynomial with two coefficients, as in OpenCV) and its inverse.
#include "pliant/lens.hpp"

#include "camera/pixel_aspect.hpp"

namespace pliant {

namespace {

struct LensTuning {
  /// Newton steps of the inverse, count, at most. Bisection guards them; the tests' lenses need six. Not tuned.
  int newton_steps = 16;
  /// The polynomial is used up to this multiple of the corners' radius. Points just outside the image are then undistorted
  /// by the polynomial too. Round value.
  float beyond_corners = 1.05f;
  /// Smallest and largest slope of the distorted radius. Beyond them one pixel maps to more than twenty, or twenty to less
  /// than one. Round values.
  float least_slope = 0.05f, most_slope = 20;
  /// Steps from the centre to the corner at which the slope is checked, count. Round value.
  int slope_checks = 1024;
};
constexpr LensTuning kLensTuning{};

}  // namespace

Lens Lens::of_square_pixels() const {
  Lens lens = *this;
  lens.camera_.aspect = 1;
  lens.camera_.cy /= camera_.aspect;
  lens.is_none_ = camera_.k1 == 0 && camera_.k2 == 0;
  return lens;
}

/// r L(r), continued along its tangent, and its derivative.
float Lens::radius(float r, float* slope) const {
  if (r >= end_) {
    *slope = end_slope_;
    return end_radius_ + end_slope_ * (r - end_);
  }
  const float s = r * r;
  *slope = 1 + s * (3 * camera_.k1 + 5 * camera_.k2 * s);
  return r * (1 + s * (camera_.k1 + camera_.k2 * s));
}

/// Newton steps inside an interval that shrinks from both ends. A step that leaves it is replaced by its middle.
float Lens::undistorted_radius(float seen) const {
  if (seen >= end_radius_) return end_ + (seen - end_radius_) / end_slope_;
  float low = 0, high = end_, r = min(seen, end_);
  for (int k = 0; k < kLensTuning.newton_steps; ++k) {
    float slope;
    const float off = radius(r, &slope) - seen;
    if (off > 0)
      high = r;
    else
      low = r;
    const float next = r - off / slope;
    const float inside = next >= low && next <= high ? next : 0.5f * (low + high);
    if (inside == r) break;
    r = inside;
  }
  return r;
}

Status Lens::make(const Camera& camera, int width, int height, Lens* lens) {
  if (lens == nullptr || width <= 0 || height <= 0 || !is_possible(Pose{}, camera) ||
      !is_finite(Vec2{camera.k1, camera.k2}) || !is_aspect(camera.aspect))
    return Status::bad_argument;
  Lens made;
  made.camera_ = camera;
  made.is_none_ = camera.k1 == 0 && camera.k2 == 0 && camera.aspect == 1;
  const auto right = static_cast<float>(width) - 0.5f, bottom = static_cast<float>(height) - 0.5f;
  const float x = max(magnitude(camera.cx + 0.5f), magnitude(right - camera.cx)) / camera.f;
  const float y =
      max(magnitude(camera.cy + 0.5f), magnitude(bottom - camera.cy)) / (camera.aspect * camera.f);
  const float corner = kLensTuning.beyond_corners * length(Vec2{x, y});
  // Outwards in small steps, for as long as the radius grows, until it reaches the corner.
  made.end_ = 1e30f;
  const float step = 4 * corner / kLensTuning.slope_checks;
  float reached = 0, r = 0, slope = 1;
  for (int k = 1; k <= kLensTuning.slope_checks && reached < corner; ++k) {
    r = static_cast<float>(k) * step;
    reached = made.radius(r, &slope);
    if (!(slope >= kLensTuning.least_slope && slope <= kLensTuning.most_slope)) return Status::bad_argument;
  }
  if (!(reached >= corner)) return Status::bad_argument;
  made.end_ = r;
  made.end_radius_ = reached;
  made.end_slope_ = slope;
  *lens = made;
  return Status::ok;
}

/// With (u,v) = r (cos, sin): the map is radial, so its derivative has the slope along the radius and L across it.
Vec2 Lens::distorted(Vec2 ideal, Mat2* derivative) const {
  const float per_f = 1.0f / camera_.f;
  const Vec2 n{per_f * (ideal.x - camera_.cx), per_f * (ideal.y - camera_.cy)};
  const float r = length(n);
  float slope;
  const float seen = radius(r, &slope);
  const float grow = r > 1e-9f ? seen / r : 1.0f;
  if (derivative != nullptr) {
    const Vec2 u = r > 1e-9f ? (1.0f / r) * n : Vec2{1, 0};
    const float extra = r > 1e-9f ? slope - grow : 0.0f;
    *derivative = {grow + extra * u.x * u.x, extra * u.x * u.y, camera_.aspect * extra * u.x * u.y,
                   camera_.aspect * (grow + extra * u.y * u.y)};
  }
  return {camera_.cx + camera_.f * grow * n.x, camera_.cy + camera_.aspect * camera_.f * grow * n.y};
}

Vec2 Lens::undistorted(Vec2 seen) const {
  const float per_f = 1.0f / camera_.f;
  const Vec2 d{per_f * (seen.x - camera_.cx), per_f * (seen.y - camera_.cy) / camera_.aspect};
  const float distance = length(d);
  if (!(distance > 1e-9f)) return {camera_.cx, camera_.cy};
  const float grow = camera_.f * undistorted_radius(distance) / distance;
  return {camera_.cx + grow * d.x, camera_.cy + grow * d.y};
}

}  // namespace pliant
