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

/// The iris lies where the pupil's ray meets the sphere around the eyeball's middle, on the near side. \return 0: it does not meet
/// it.
Vec3 direction_of(const SeenEye& eye, const View& view, const Projector& projector) {
  const Vec3 offset{eye.corners.x > 0 ? kTuning.ball_mm.x : -kTuning.ball_mm.x, kTuning.ball_mm.y,
                    kTuning.ball_mm.z};
  const Vec3 ball = projector.to_camera(eye.corners + offset);
  const float per_px = view.rho / view.s;  // 1 / f
  const Vec2 pupil = pupil_of(eye, view, projector);
  const Vec3 ray = normalised(Vec3{per_px * (pupil.x - view.c.x), per_px * (pupil.y - view.c.y), 1});
  const Vec3 across = dot(ray, ball) * ray - ball;  // from the eyeball's middle to the ray
  const float square = kTuning.iris_mm * kTuning.iris_mm - dot(across, across);
  if (!(square > 0)) return {};
  const Vec3 g = across - square_root(square) * ray;
  return normalised(Vec3{dot(g, projector.rotated({1, 0, 0})), dot(g, projector.rotated({0, 1, 0})),
                         dot(g, projector.rotated({0, 0, 1}))});
}

}  // namespace

Vec3 find_gaze(Span<const SeenEye> eyes, const View& view) {
  const Projector projector(view, true);
  if (!(-projector.rotated({0, 0, 1}).z >= kTuning.least_facing)) return {};
  Vec3 sum;
  for (const SeenEye& eye : eyes)
    if (eye.opening_mm >= kTuning.least_opening_mm) sum = sum + direction_of(eye, view, projector);
  return normalised(sum);
}

Vec3 smoothed_gaze(Vec3 gaze, Vec3 seen) {
  const bool is_known = dot(gaze, gaze) > 0 && dot(seen, seen) > 0;
  return is_known ? normalised(gaze + kTuning.rate * (seen - gaze)) : seen;
}

}  // namespace pliant
