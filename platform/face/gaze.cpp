#include "face/gaze.hpp"

#include "face/face_picture.hpp"

namespace pliant {

namespace {

constexpr const GazeTuning& kTuning = kGazeTuning;

/// Between where the pupil is read and where the upper lid puts it.
Vec2 pupil_of(const SeenEye& eye, const View& view, const Projector& projector) {
  const float higher = clamp(eye.lid_mm - kTuning.lid_mm, -kTuning.most_lid_mm, kTuning.most_lid_mm);
  return eye.pupil - (kTuning.lid_weight * higher * view.s) * down_of(projector);
}

/// From the eyeball's middle to the iris, mm, camera axes: the iris lies where the pupil's ray meets the sphere around the
/// middle, on the near side. \return 0: it does not meet it.
Vec3 iris_of(const SeenEye& eye, const View& view, const Projector& projector) {
  const Vec3 offset{eye.corners.x > 0 ? kTuning.ball_mm.x : -kTuning.ball_mm.x, kTuning.ball_mm.y,
                    kTuning.ball_mm.z};
  const Vec3 ball = projector.to_camera(eye.corners + offset);
  const float per_px = view.rho / view.s;  // 1 / f
  const Vec2 pupil = pupil_of(eye, view, projector);
  const Vec3 ray = normalised(Vec3{per_px * (pupil.x - view.c.x), per_px * (pupil.y - view.c.y), 1});
  const Vec3 across = dot(ray, ball) * ray - ball;  // from the eyeball's middle to the ray
  const float square = kTuning.iris_mm * kTuning.iris_mm - dot(across, across);
  return square > 0 ? across - square_root(square) * ray : Vec3{};
}

}  // namespace

Vec3 find_gaze(Span<const SeenEye> eyes, const View& view) {
  if (!(camera_direction(view).z >= kTuning.least_facing)) return {};
  const Projector projector(view, true);
  Vec3 sum;  // both irises are as far from their eyeball's middle: the mean of their directions
  for (const SeenEye& eye : eyes)
    if (eye.opening_mm >= kTuning.least_opening_mm) sum = sum + iris_of(eye, view, projector);
  const Vec3 r = rotation_matrix(conjugate(view.q)) * sum;  // y and z are opposite in the model (Projector::to_camera)
  return normalised(Vec3{r.x, -r.y, -r.z});
}

// A low pass of first order, as of a step of that time: it follows about as fast at any frame rate.
Vec3 smoothed_gaze(Vec3 gaze, Vec3 seen, float seconds) {
  const bool is_known = dot(gaze, gaze) > 0 && dot(seen, seen) > 0;
  const float rate = seconds / (seconds + kTuning.half_way_s);
  return is_known ? normalised(gaze + rate * (seen - gaze)) : seen;
}

}  // namespace pliant
