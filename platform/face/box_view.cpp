#include "face/box_view.hpp"

namespace pliant {

Status view_of_box(Cascade& cascade, const float* q, const FaceBox& box, const Camera& camera,
                   const Lens& lens, View* view) {
  const Model& model = cascade.model();
  const char* const corners[] = {"ibug36", "ibug45", "ibug48", "ibug54"};
  Vec3 middle;
  for (const char* name : corners) {
    const std::uint16_t k = model.find_landmark(name);
    if (k == kNone) return Status::not_found;
    const Landmark& l = model.landmarks()[k];
    middle = middle + 0.25f * cascade.surface_point({l.u, l.v}, q);
  }
  View out;
  out.rho = clamp(box.side / (kFaceBoxMm * camera.f), kMinRho, kMaxRho);
  out.s = camera.f * out.rho;
  out.c = {camera.cx, camera.cy};
  const float depth = 1 - out.rho * middle.z;
  const Vec2 offset = (depth / out.s) * (lens.undistort(box.center) - out.c);
  out.tau = {offset.x - middle.x, offset.y + middle.y};
  *view = out;
  return Status::ok;
}

}  // namespace pliant
