#include "fit/fit_start.hpp"

#include "fit/fit_tuning.hpp"
#include "model/ibug_names.hpp"

namespace pliant {

namespace {

/// Mean of the points on the model (mm) and in the image (px).
struct Means {
  Vec3 p;
  Vec2 x;
};

Means means_of(Span<const Correspondence> points, const Vec3* p) {
  Means mean;
  const float fraction = 1.0f / static_cast<float>(points.count);
  for (std::size_t i = 0; i < points.count; ++i) {
    mean.p = mean.p + fraction * p[i];
    mean.x = mean.x + fraction * points[i].x;
  }
  return mean;
}

/// Sets the offset of a view so that the mean point is at its mean image position.
void centre_view(View& view, const Means& mean) {
  const Vec3 m = Projector(view, true).rotated(mean.p);
  const Vec2 offset = (1.0f / view.s) * (mean.x - view.c);
  view.tau = {offset.x - m.x, offset.y - m.y};
}

/// The rows r_1, r_2 of the weak-perspective image x = s R_12 p + offset by least squares: (sum d d^T) r_k = sum d x_k, with
/// d and x measured from their means.
struct WeakPerspectiveRows {
  Vec3 x, y;
};

WeakPerspectiveRows solve_rows(Span<const Correspondence> points, const Vec3* p, const Means& mean) {
  float a[3][3] = {}, b[2][3] = {};
  for (std::size_t i = 0; i < points.count; ++i) {
    const Vec3 d = p[i] - mean.p;
    const Vec2 x = points[i].x - mean.x;
    const float v[3] = {d.x, d.y, d.z};
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) a[r][c] += v[r] * v[c];
      b[0][r] += v[r] * x.x;
      b[1][r] += v[r] * x.y;
    }
  }
  const float ridge = kFitTuning.ridge_fraction * (a[0][0] + a[1][1] + a[2][2]) + 1e-6f;
  for (int k = 0; k < 3; ++k) a[k][k] += ridge;
  const Vec3 r0{a[0][0], a[0][1], a[0][2]}, r1{a[1][0], a[1][1], a[1][2]}, r2{a[2][0], a[2][1], a[2][2]};
  const Vec3 c0 = cross(r1, r2), c1 = cross(r2, r0), c2 = cross(r0, r1);
  const float inverse = 1.0f / dot(r0, c0);
  const auto solve = [&](const float* g) { return inverse * (g[0] * c0 + g[1] * c1 + g[2] * c2); };
  return {solve(b[0]), solve(b[1])};
}

/// The view of the weak-perspective solution, with the rotation nearest to its rows. `mirrored` takes the other solution
/// that a nearly flat object has: tilted the other way.
View weak_perspective_view(WeakPerspectiveRows rows, const Means& mean, bool mirrored, Vec2 centre,
                           float focal) {
  if (mirrored) {
    rows.x.z = -rows.x.z;
    rows.y.z = -rows.y.z;
  }
  View view;
  // Within the distances of a view, so that f = s / rho is `focal` also where the points say otherwise.
  view.s = clamp(0.5f * (length(rows.x) + length(rows.y)), kMinRho * focal, kMaxRho * focal);
  const Vec3 sum = normalised(normalised(rows.x) + normalised(rows.y));
  const Vec3 difference = normalised(normalised(rows.x) - normalised(rows.y));
  const float h = 0.70710678f;  // sqrt(1/2)
  const Vec3 i = h * (sum + difference), j = h * (sum - difference), k = cross(i, j);
  const Mat3 rotation{{{i.x, -i.y, -i.z}, {j.x, -j.y, -j.z}, {k.x, -k.y, -k.z}}};
  view.q = quaternion(rotation);
  view.c = centre;
  view.rho = view.s / focal;
  centre_view(view, mean);
  return view;
}

/// A view of the same scale and mean, with the model turned by `yaw_rad` about the vertical.
View turned_view(const View& like, float yaw_rad, const Means& mean) {
  View view = like;
  view.q = exp_rotation({0, yaw_rad, 0});
  centre_view(view, mean);
  return view;
}

}  // namespace

void find_initial_view(FitProblem& problem, Vec2 centre) {
  const Vec3* const position = problem.held_position;
  const Means mean = means_of(problem.points, position);
  const WeakPerspectiveRows rows = solve_rows(problem.points, position, mean);
  const float yaw = kFitTuning.start_yaw_rad;
  const View first = weak_perspective_view(rows, mean, false, centre, problem.prior_focal);
  const View candidates[] = {first, weak_perspective_view(rows, mean, true, centre, problem.prior_focal),
                             turned_view(first, -yaw, mean), turned_view(first, 0, mean),
                             turned_view(first, yaw, mean)};
  View best = first;
  float best_cost = 1e30f;
  for (const View& candidate : candidates) {
    problem.view = candidate;
    problem.loss = Loss::huber;
    problem.update_scale();  // wide at first, so that gross errors of the candidate don't stop it
    problem.minimise(kFitTuning.start_iterations);
    problem.update_scale();
    problem.minimise(kFitTuning.start_iterations_rescaled);
    const float cost = problem.cost(problem.q, problem.view);
    if (cost < best_cost) {
      best_cost = cost;
      best = problem.view;
    }
  }
  problem.view = best;
}

Status view_from_box(Cascade& cascade, const float* q, Vec2 corner, Vec2 size, const Camera& camera,
                     View* view) {
  const Model& model = cascade.model();
  if (!(size.x > 0 && size.y > 0 && camera.f > 0)) return Status::bad_argument;
  Vec3 low{1e9f, 1e9f, 1e9f}, high{-1e9f, -1e9f, -1e9f};
  const auto include = [&](Vec3 p) {
    low = min(low, p);
    high = max(high, p);
  };
  std::size_t found = 0;
  for (const Landmark& l : model.landmarks())
    if (is_ibug_landmark(l.name)) {
      include(cascade.surface_point(l.uv(), q));
      ++found;
    }
  if (found < 4)
    for (Vec2 uv : model.base_uv()) include(cascade.surface_point(uv, q));
  const Vec3 extent = high - low, centre = 0.5f * (low + high);
  if (!(extent.x > 0 && extent.y > 0)) return Status::bad_argument;
  View out;
  // As weak_perspective_view.
  out.s = clamp(0.5f * (size.x / extent.x + size.y / extent.y), kMinRho * camera.f, kMaxRho * camera.f);
  out.c = {camera.cx, camera.cy};
  out.rho = out.s / camera.f;
  const Vec2 middle = corner + 0.5f * size;
  const Vec2 offset = (1.0f / out.s) * (middle - out.c);
  out.tau = {offset.x - centre.x, offset.y + centre.y};
  if (!is_possible(pose_of(out), camera)) return Status::bad_argument;
  *view = out;
  return Status::ok;
}

}  // namespace pliant
