// Scaled-perspective projection and its derivatives (docs/algorithms.md, sections 4.1 to 4.3; the paper, Eq. 10).
#include "pliant/camera.hpp"

namespace pliant {

namespace {

/// e^x by argument halving and a short series; x is clamped to +-8. Relative error below 1e-6.
float exponential(float x) {
  float y = clamp(x, -8, 8) * (1.0f / 32);
  float e = 1 + y * (1 + y * (0.5f + y * (1.0f / 6 + y * (1.0f / 24))));
  for (int k = 0; k < 5; ++k) e = e * e;
  return e;
}

}  // namespace

bool is_possible(const Pose& pose, const Camera& camera) {
  constexpr float kLargest = kLargestFocalPx, kRounding = 1.001f;
  constexpr float kNearest = 1 / (kMaxRho * kRounding), kFarthest = kRounding / kMinRho;
  const float lengths[] = {pose.t.x, pose.t.y, camera.cx, camera.cy, camera.f};
  for (const float length : lengths)
    if (!(magnitude(length) <= kLargest)) return false;  // as all comparisons here, for NaN too
  const Quat& q = pose.q;
  const float squared = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
  return squared > 0.5f && squared < 2 && pose.t.z >= kNearest && pose.t.z <= kFarthest &&
         camera.f >= kSmallestFocalPx;
}

View view_of(const Pose& pose, const Camera& camera) {
  View view;
  view.q = pose.q;
  view.rho = clamp(1.0f / pose.t.z, kMinRho, kMaxRho);
  view.s = camera.f * view.rho;
  view.tau = {pose.t.x, pose.t.y};
  view.c = {camera.cx, camera.cy};
  return view;
}

Pose pose_of(const View& view) {
  return {view.q, {view.tau.x, view.tau.y, 1.0f / view.rho}};
}

Camera camera_of(const View& view) {
  return {view.s / view.rho, view.c.x, view.c.y};
}

Vec3 camera_direction(const View& view) {
  const Vec3 towards = rotation_matrix(conjugate(view.q)) * Vec3{0, 0, -1};
  return {towards.x, -towards.y, -towards.z};
}

View moved(const View& view, const float* step, int unknowns) {
  View out = view;
  out.q = normalised(exp_rotation({step[kTurnX], step[kTurnY], step[kTurnZ]}) * view.q);
  const float grow = exponential(step[kLogScale]);
  out.s = view.s * grow;
  out.tau = {view.tau.x + step[kShiftX], view.tau.y + step[kShiftY]};
  const float rho = view.rho * (unknowns > kLogRho ? exponential(step[kLogRho]) : grow);
  out.rho = clamp(rho, kMinRho, kMaxRho);
  if (unknowns <= kLogRho) out.s = view.s * (out.rho / view.rho);  // at the bound too, f = s / rho stays
  return out;
}

Projector::Projector(const View& view, bool focal_is_known)
    : view_(view), rotation_(rotation_matrix(view.q)), focal_is_known_(focal_is_known) {
  for (auto& row : rotation_.m) {
    row[1] = -row[1];
    row[2] = -row[2];
  }
}

Vec3 Projector::to_camera(Vec3 p) const {
  return rotation_ * p + Vec3{view_.tau.x, view_.tau.y, 1.0f / view_.rho};
}

bool Projector::project(Vec3 p, Vec2* x) const {
  return project_rotated(rotated(p), x);
}

bool Projector::project(Vec3 p, Vec2* x, Derivatives* d) const {
  const Vec3 r = rotation_ * p;
  const float depth = 1 + view_.rho * r.z;
  if (!(depth >= kMinDepthRatio)) return false;
  const float g = view_.s / depth;
  const Vec2 off{g * (r.x + view_.tau.x), g * (r.y + view_.tau.y)};
  *x = view_.c + off;
  // dx/dp' = g [1 0 -rho off_x/s ; 0 1 -rho off_y/s], written with k = rho / depth.
  const float k = view_.rho / depth;
  const Vec2 along_z{-k * off.x, -k * off.y};
  d->pose[kTurnX] = {along_z.x * r.y, -g * r.z + along_z.y * r.y};
  d->pose[kTurnY] = {g * r.z - along_z.x * r.x, -along_z.y * r.x};
  d->pose[kTurnZ] = {-g * r.y, g * r.x};
  const Vec2 along_rho{along_z.x * r.z, along_z.y * r.z};
  d->pose[kLogScale] = focal_is_known_ ? off + along_rho : off;
  d->pose[kShiftX] = {g, 0};
  d->pose[kShiftY] = {0, g};
  d->pose[kLogRho] = along_rho;
  // One by one: GCC makes a vector of such a short loop, and gathers it again.
  const auto& m = rotation_.m;
  const auto column = [&](int c) {
    d->m[0][c] = g * m[0][c] + along_z.x * m[2][c];
    d->m[1][c] = g * m[1][c] + along_z.y * m[2][c];
  };
  column(0);
  column(1);
  column(2);
  return true;
}

}  // namespace pliant
