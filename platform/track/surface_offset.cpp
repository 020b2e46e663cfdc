#include "track/surface_offset.hpp"

namespace pliant {

bool find_offset(const View& view, const Lens& lens, Vec3 p, Vec2 x, Vec3* offset) {
  const Projector projector(view, true);
  Vec2 own;
  if (!is_finite(x) || !projector.project(p, &own)) return false;
  const float mm_per_px = projector.to_camera(p).z * view.rho / view.s;
  const Vec2 across = mm_per_px * (lens.undistort(x) - own);
  const Vec3 in_camera{across.x, across.y, 0};
  *offset = {dot(projector.rotated({1, 0, 0}), in_camera), dot(projector.rotated({0, 1, 0}), in_camera),
             dot(projector.rotated({0, 0, 1}), in_camera)};
  return true;
}

Vec2 place_in(const View& view, const Lens& lens, Vec3 p) {
  Vec2 x;
  return Projector(view, true).project(p, &x) ? lens.distort(x) : kNowhere;
}

bool project_beside(Estimator& estimator, Vec2 uv, Vec3 offset, Vec2* x) {
  Vec2 ideal;
  if (!Projector(estimator.view(), true).project(estimator.surface_point(uv) + offset, &ideal)) return false;
  *x = estimator.lens().distort(ideal);
  return true;
}

}  // namespace pliant
