#include "host/learn/sample_view.hpp"

#include <cmath>

#include "face/ibug_landmarks.hpp"

namespace pliant::host::learn {

Quat rotation_of(float yaw, float pitch, float roll) {
  const Quat x{std::cos(0.5f * pitch), std::sin(0.5f * pitch), 0, 0},
      y{std::cos(0.5f * yaw), 0, std::sin(0.5f * yaw), 0},
      z{std::cos(0.5f * roll), 0, 0, std::sin(0.5f * roll)};
  return normalised(z * (y * x));
}

std::vector<Vec2> projected(const std::vector<Vec3>& points, const Pose& pose, const Camera& camera) {
  const Projector projector(view_of(pose, camera), true);
  std::vector<Vec2> out(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) (void)projector.project(points[k], &out[k]);
  return out;
}

FaceBox face_box_in(const Model& model, const std::vector<Vec2>& landmarks, const Pose& pose,
                    const Camera& camera) {
  return box_at_landmarks(model, view_of(pose, camera).s, places_of({landmarks.data(), landmarks.size()}));
}

void place_face(const Model& model, const std::vector<Vec3>& landmarks, Quat rotation,
                const FacePlacement& placement, Camera* camera, Pose* pose) {
  const float scale = placement.box.side / kFaceBoxMm;
  *camera = centred_camera(placement.picture_px, placement.picture_px, scale * placement.distance_mm);
  *pose = {rotation, {0, 0, placement.distance_mm}};
  // Away from the axis perspective moves the landmarks a little against each other; further steps make up for it.
  for (int step = 0; step < 3; ++step) {
    const FaceBox box = face_box_in(model, projected(landmarks, *pose, *camera), *pose, *camera);
    const Vec2 missing = placement.box.center - box.center;
    pose->t = pose->t + (1 / scale) * Vec3{missing.x, missing.y, 0};
  }
}

}  // namespace pliant::host::learn
