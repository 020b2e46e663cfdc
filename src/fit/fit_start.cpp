// Where a fit starts: weak perspective by least squares (ALGORITHMS 4.4), turned views beside it, or a face box.
#include "fit/fit_problem.hpp"

namespace pliant {

namespace {

/// Weak-perspective pose (POS): image = s R_12 p + offset by least squares, then the nearest rotation.
/// `mirrored` gives the other solution of a nearly flat object, tilted the other way.
View weak_perspective(Span<const Correspondence> points, const Vec3* p, bool mirrored, Vec2 centre,
                      float focal) {
  Vec3 mean;
  Vec2 mean_x;
  const float share = 1.0f / static_cast<float>(points.count);
  for (std::size_t i = 0; i < points.count; ++i) {
    mean = mean + share * p[i];
    mean_x = mean_x + share * points[i].x;
  }
  float a[3][3] = {}, b[2][3] = {};  // normal matrix of the centred points, right-hand sides
  for (std::size_t i = 0; i < points.count; ++i) {
    const Vec3 d = p[i] - mean;
    const Vec2 x = points[i].x - mean_x;
    const float v[3] = {d.x, d.y, d.z};
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) a[r][c] += v[r] * v[c];
      b[0][r] += v[r] * x.x;
      b[1][r] += v[r] * x.y;
    }
  }
  // A ridge in proportion keeps flat sets of points solvable.
  const float ridge = 1e-3f * (a[0][0] + a[1][1] + a[2][2]) + 1e-6f;
  for (int k = 0; k < 3; ++k) a[k][k] += ridge;
  const Vec3 r0{a[0][0], a[0][1], a[0][2]}, r1{a[1][0], a[1][1], a[1][2]}, r2{a[2][0], a[2][1], a[2][2]};
  const Vec3 c0 = cross(r1, r2), c1 = cross(r2, r0), c2 = cross(r0, r1);
  const float inverse = 1.0f / dot(r0, c0);
  const auto solve = [&](const float* g) { return inverse * (g[0] * c0 + g[1] * c1 + g[2] * c2); };
  Vec3 x_row = solve(b[0]), y_row = solve(b[1]);
  if (mirrored) {
    x_row.z = -x_row.z;
    y_row.z = -y_row.z;
  }
  View view;
  view.s = max(0.5f * (length(x_row) + length(y_row)), 1e-6f);
  const Vec3 sum = normalised(normalised(x_row) + normalised(y_row));
  const Vec3 difference = normalised(normalised(x_row) - normalised(y_row));
  const float h = 0.70710678f;
  const Vec3 i = h * (sum + difference), j = h * (sum - difference), k = cross(i, j);
  const Mat3 rotation{{{i.x, -i.y, -i.z}, {j.x, -j.y, -j.z}, {k.x, -k.y, -k.z}}};
  view.q = quaternion(rotation);
  view.c = centre;
  view.rho = clamp(view.s / focal, kMinRho, kMaxRho);
  const Vec3 m = Projector(view, true).rotated(mean);
  const Vec2 offset = (1.0f / view.s) * (mean_x - centre);
  view.tau = {offset.x - m.x, offset.y - m.y};
  return view;
}

/// The same scale and offset, but facing the camera turned by `yaw` about the vertical.
View turned_view(const View& like, float yaw, Vec3 mean, Vec2 mean_x) {
  View view = like;
  view.q = exp_rotation({0, yaw, 0});
  const Vec3 m = Projector(view, true).rotated(mean);
  const Vec2 offset = (1.0f / view.s) * (mean_x - view.c);
  view.tau = {offset.x - m.x, offset.y - m.y};
  return view;
}

}  // namespace

void find_start(FitProblem& problem, const Vec3* position, Vec2 centre) {
  const auto points = problem.points;
  Vec3 mean;
  Vec2 mean_x;
  const float share = 1.0f / static_cast<float>(points.count);
  for (std::size_t i = 0; i < points.count; ++i) {
    mean = mean + share * position[i];
    mean_x = mean_x + share * points[i].x;
  }
  const View first = weak_perspective(points, position, false, centre, problem.prior_focal);
  View best = first;
  float best_cost = 1e30f;
  constexpr float kYaw[3] = {-0.5f, 0, 0.5f};
  for (int k = 0; k < 5; ++k) {
    problem.view = k < 2 ? weak_perspective(points, position, k == 1, centre, problem.prior_focal)
                         : turned_view(first, kYaw[k - 2], mean, mean_x);
    // A wide robust scale first, so that the basin is wide.
    problem.loss = Loss::huber;
    problem.update_scale();
    problem.minimise(6);
    problem.update_scale();
    problem.minimise(4);
    const float cost = problem.cost(problem.q, problem.view);
    if (cost < best_cost) {
      best_cost = cost;
      best = problem.view;
    }
  }
  problem.view = best;
}

Status view_from_box(const Model& model, Cascade& cascade, const float* q, Vec2 corner, Vec2 size,
                     const Camera& camera, View* view) {
  if (!is_finite(corner) || !is_finite(size) || !(size.x > 0 && size.y > 0) || !(camera.f > 0))
    return Status::bad_argument;
  Vec3 low{1e9f, 1e9f, 1e9f}, high{-1e9f, -1e9f, -1e9f};
  const auto include = [&](Vec3 p) {
    low = {min(low.x, p.x), min(low.y, p.y), min(low.z, p.z)};
    high = {max(high.x, p.x), max(high.y, p.y), max(high.z, p.z)};
  };
  std::size_t found = 0;
  for (const Landmark& l : model.landmarks())
    if (l.name[0] == 'i' && l.name[1] == 'b' && l.name[2] == 'u' && l.name[3] == 'g') {
      include(cascade.surface_point({l.u, l.v}, q));
      ++found;
    }
  if (found < 4)
    for (Vec2 uv : model.base_uv()) include(cascade.surface_point(uv, q));
  const Vec3 extent = high - low, centre = 0.5f * (low + high);
  if (!(extent.x > 0 && extent.y > 0)) return Status::bad_argument;
  View out;
  out.s = 0.5f * (size.x / extent.x + size.y / extent.y);
  out.c = {camera.cx, camera.cy};
  out.rho = clamp(out.s / camera.f, kMinRho, kMaxRho);
  const Vec2 middle = corner + 0.5f * size;
  const Vec2 offset = (1.0f / out.s) * (middle - out.c);
  out.tau = {offset.x - centre.x, offset.y + centre.y};
  *view = out;
  return Status::ok;
}

}  // namespace pliant
