#include "face/box_view.hpp"

#include "face/ibug_landmarks.hpp"

namespace pliant {

Status view_of_box(Cascade& cascade, const float* q, const FaceBox& box, float roll, const Camera& camera,
                   const Lens& lens, View* view) {
  const Model& model = cascade.model();
  std::uint16_t corners[4];
  if (!find_box_corners(model, corners)) return Status::not_found;
  Vec3 middle;
  for (const std::uint16_t k : corners) {
    const Landmark& l = model.landmarks()[k];
    middle = middle + 0.25f * cascade.surface_point(l.uv(), q);
  }
  View out;
  out.q = exp_rotation({0, 0, roll});
  out.rho = clamp(box.side / (kFaceBoxMm * camera.f), kMinRho, kMaxRho);
  out.s = camera.f * out.rho;
  out.c = {camera.cx, camera.cy};
  const float depth = 1 - out.rho * middle.z;
  const Vec2 offset = (depth / out.s) * (lens.undistort(box.center) - out.c);
  const float cosine = 1 - 2 * out.q.z * out.q.z, sine = 2 * out.q.w * out.q.z;
  out.tau = {offset.x - (cosine * middle.x + sine * middle.y),
             offset.y - (sine * middle.x - cosine * middle.y)};
  *view = out;
  return Status::ok;
}

}  // namespace pliant
