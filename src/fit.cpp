// Shape and pose from correspondences (the paper, section 6; ALGORITHMS 4.4, 5.2, 5.6). Minimises, over pose, focal
// length when unknown, and the free parameters,
//   sum_i sigma^2 rho(|x_i - Proj(F(q,u_i,v_i))| / (sd_i sigma)) + sum_k (q_k / sd_k)^2 / 2
// i.e. Eq. 8 with a robust loss and the parameters' prior, without which 80 points do not determine 100 parameters.
#include "pliant/fit.hpp"

#include "pliant/robust.hpp"

namespace pliant {

namespace {

/// Natural logarithm for x > 0: square roots until near 1, then the series of atanh.
float logarithm(float x) {
  float scale = 2;
  for (int k = 0; k < 8 && (x < 0.9f || x > 1.1f); ++k) {
    x = square_root(x);
    scale *= 2;
  }
  const float t = (x - 1) / (x + 1), t2 = t * t;
  return scale * t * (1 + t2 * (1.0f / 3 + t2 * (1.0f / 5)));
}

}  // namespace

/// One minimisation: a choice of unknowns and of loss, on the points of the fitter.
struct FitProblem {
  Fitter& fitter;
  Span<const Correspondence> points;
  const FitOptions& options;
  float* q;              // accepted parameters
  View view{}, trial{};  // accepted and trial view
  Loss loss = Loss::huber;
  float scale = 1;  // robust scale, in standard deviations of a point
  bool shape_is_free = true;
  bool focal_is_known = true;
  float prior_focal = 0;

  int pose_unknowns() const { return focal_is_known ? kPoseUnknowns : kPoseUnknownsWithFocal; }
  std::size_t columns() const { return shape_is_free ? fitter.cascade_.column_count() : 0; }

  LossValue point_loss(const Correspondence& c, Vec2 residual) const {
    return evaluate(loss, length(residual) / (c.sd_px * scale));
  }

  float prior_cost(const float* parameters, const View& v) const {
    float cost = 0;
    for (std::size_t k = 0; k < columns(); ++k) {
      const std::uint16_t p = fitter.cascade_.parameter_of(k);
      const float z = parameters[p] / fitter.cascade_.model().parameters()[p].sd;
      cost += 0.5f * z * z;
    }
    if (!focal_is_known) {
      const float z = logarithm(v.s / (v.rho * prior_focal)) / options.focal_log_sd;
      cost += 0.5f * z * z;
    }
    return cost;
  }

  float cost(const float* parameters, const View& v) const {
    const Projector projector(v, focal_is_known);
    float sum = 0;
    for (std::size_t i = 0; i < points.count; ++i) {
      const Vec3 p = fitter.cascade_.evaluate(fitter.baked_at(i), parameters);
      Vec2 x;
      if (!projector.project(p, &x)) return 1e30f;
      sum += point_loss(points[i], points[i].x - x).rho;
    }
    return scale * scale * sum + prior_cost(parameters, v);
  }

  float linearise(NormalEquations& equations) {
    const auto pose = static_cast<std::size_t>(pose_unknowns());
    equations.reset(pose + columns());
    const Projector projector(view, focal_is_known);
    float sum = 0;
    for (std::size_t i = 0; i < points.count; ++i) {
      Jacobian jacobian;
      const Vec3 p = fitter.cascade_.evaluate(fitter.baked_at(i), q, &jacobian);
      Vec2 x;
      Projector::Derivatives d;
      if (!projector.project(p, &x, &d)) continue;
      const Vec2 residual = points[i].x - x;
      const LossValue value = point_loss(points[i], residual);
      sum += value.rho;
      if (value.weight <= 0) continue;
      std::uint16_t* unknown = fitter.unknown_;
      Vec2* column = fitter.column_;
      std::size_t n = 0;
      for (; n < pose; ++n) {
        unknown[n] = static_cast<std::uint16_t>(n);
        column[n] = d.pose[n];
      }
      for (std::size_t k = 0; shape_is_free && k < jacobian.count; ++k, ++n) {
        unknown[n] = static_cast<std::uint16_t>(pose + jacobian.list[k]);
        column[n] = d.along(jacobian.column[jacobian.list[k]]);
      }
      const float w = value.weight / (points[i].sd_px * points[i].sd_px);
      equations.add(unknown, column, n, residual, {w, 0, w});
    }
    add_priors(equations, pose);
    return scale * scale * sum + prior_cost(q, view);
  }

  void add_priors(NormalEquations& equations, std::size_t pose) {
    const auto parameters = fitter.cascade_.model().parameters();
    for (std::size_t k = 0; k < columns(); ++k) {
      const std::uint16_t p = fitter.cascade_.parameter_of(k);
      equations.add_prior(pose + k, -q[p], 1.0f / (parameters[p].sd * parameters[p].sd));
      equations.set_limits(pose + k, min(parameters[p].minimum - q[p], 0),
                           max(parameters[p].maximum - q[p], 0));
    }
    for (std::size_t k = 0; k < 3; ++k) equations.set_limits(k, -0.5f, 0.5f);
    equations.set_limits(kLogScale, -0.7f, 0.7f);
    if (focal_is_known) return;
    equations.set_limits(kLogRho, -0.7f, 0.7f);
    // log f = log s - log rho, around the default focal length.
    const std::uint16_t pair[2] = {kLogScale, kLogRho};
    const Vec2 row[2] = {{1, 0}, {-1, 0}};
    const float w = 1.0f / (options.focal_log_sd * options.focal_log_sd);
    equations.add(pair, row, 2, {-logarithm(view.s / (view.rho * prior_focal)), 0}, {w, 0, 0});
  }

  float try_step(const float* step) {
    trial = moved(view, step, pose_unknowns());
    float* next = fitter.trial_q_;
    for (std::size_t i = 0; i < fitter.cascade_.parameter_count(); ++i) next[i] = q[i];
    for (std::size_t k = 0; k < columns(); ++k) {
      const std::uint16_t p = fitter.cascade_.parameter_of(k);
      const Parameter& limits = fitter.cascade_.model().parameters()[p];
      next[p] =
          clamp(q[p] + step[static_cast<std::size_t>(pose_unknowns()) + k], limits.minimum, limits.maximum);
    }
    return cost(next, trial);
  }

  void accept() {
    view = trial;
    for (std::size_t i = 0; i < fitter.cascade_.parameter_count(); ++i) q[i] = fitter.trial_q_[i];
  }

  SolverReport minimise(int iterations) {
    const LeastSquaresProblem problem{
        this, [](void* p, NormalEquations& e) { return static_cast<FitProblem*>(p)->linearise(e); },
        [](void* p, const float* s) { return static_cast<FitProblem*>(p)->try_step(s); },
        [](void* p) { static_cast<FitProblem*>(p)->accept(); }};
    SolverOptions solver;
    solver.max_iterations = iterations;
    return pliant::minimise(problem, solver, fitter.equations_, fitter.step_);
  }

  /// Residual lengths in standard deviations give the robust scale at the present state, but never less than the noise
  /// and the model's own misfit.
  void update_scale() {
    const Projector projector(view, focal_is_known);
    float mean_sd = 0;
    for (std::size_t i = 0; i < points.count; ++i) {
      Vec2 x = points[i].x + Vec2{1e6f, 0};
      projector.project(fitter.cascade_.evaluate(fitter.baked_at(i), q), &x);
      fitter.sorted_[i] = length(points[i].x - x) / points[i].sd_px;
      mean_sd += points[i].sd_px / static_cast<float>(points.count);
    }
    const float misfit = options.misfit_mm * view.s / mean_sd;
    scale = max(robust_scale(fitter.sorted_, points.count), square_root(1 + misfit * misfit));
  }
};

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

Status check_points(Span<const Correspondence> points, const FitOptions& options) {
  if (options.width <= 0 || options.height <= 0 || !is_finite(options.focal_px) || options.focal_px < 0)
    return Status::bad_argument;
  for (const Correspondence& c : points) {
    if (!is_finite(c.x) || !is_finite(c.uv) || !is_finite(c.sd_px) || !(c.sd_px > 0))
      return Status::bad_argument;
    if (c.uv.x < 0 || c.uv.x > 1 || c.uv.y < 0 || c.uv.y > 1) return Status::bad_argument;
  }
  return Status::ok;
}

/// Tries the analytic starts and a few turned ones with a robust pose-only fit each; the lowest cost wins.
void find_start(FitProblem& problem, Vec3* position, Vec2 centre) {
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

}  // namespace

void Fitter::lay_out(Arena& arena, const Model& model, const FitLimits& limits) {
  limits_ = limits;
  cascade_.lay_out(arena, model);
  const std::size_t parameters = model.parameters().count, unknowns = parameters + kPoseUnknownsWithFocal;
  equations_.lay_out(arena, unknowns);
  baked_ = arena.take<Vec3>(std::size_t{limits.points} * model.cascade().count);
  position_ = arena.take<Vec3>(limits.points);
  sorted_ = arena.take<float>(limits.points);
  step_ = arena.take<float>(unknowns);
  trial_q_ = arena.take<float>(parameters);
  start_q_ = arena.take<float>(parameters);
  unknown_ = arena.take<std::uint16_t>(unknowns);
  column_ = arena.take<Vec2>(unknowns);
}

Status Fitter::fit(Span<const Correspondence> points, const FitOptions& options, float* q, FitReport* report,
                   float* sd, Vec2* residuals, float* weights) {
  if (q == nullptr || report == nullptr) return Status::bad_argument;
  const Status checked = check_points(points, options);
  if (checked != Status::ok) return checked;
  if (points.count > limits_.points) return Status::capacity;
  if (points.count < 4) return Status::too_few_points;
  const std::size_t parameters = cascade_.parameter_count();
  for (std::size_t i = 0; i < parameters; ++i)
    if (!is_finite(q[i])) return Status::bad_argument;

  if (options.is_free != nullptr)
    cascade_.set_free(options.is_free);
  else
    cascade_.set_all_free();
  for (std::size_t i = 0; i < parameters; ++i) start_q_[i] = q[i];
  for (std::size_t i = 0; i < points.count; ++i) {
    cascade_.bake(points[i].uv, q, baked_at(i));
    position_[i] = cascade_.evaluate(baked_at(i), q);
  }

  FitProblem problem{*this, points, options, start_q_};
  const auto larger = static_cast<float>(options.width > options.height ? options.width : options.height);
  problem.prior_focal = options.focal_px > 0 ? options.focal_px : options.default_focal_ratio * larger;
  const Camera camera = centred_camera(options.width, options.height, problem.prior_focal);

  problem.shape_is_free = false;
  if (options.start != nullptr)
    problem.view = *options.start;
  else
    find_start(problem, position_, {camera.cx, camera.cy});
  problem.shape_is_free = true;
  problem.focal_is_known = options.focal_px > 0;

  const Loss stages[3] = {options.robust ? Loss::huber : Loss::squares,
                          options.robust ? Loss::huber : Loss::squares,
                          options.robust ? Loss::tukey : Loss::squares};
  int iterations = 0;
  for (Loss loss : stages) {
    problem.loss = loss;
    if (options.robust) problem.update_scale();
    iterations += problem.minimise(options.iterations / 3).iterations;
  }
  return conclude(problem, q, report, sd, residuals, weights, iterations);
}

Status Fitter::conclude(FitProblem& problem, float* q, FitReport* report, float* sd, Vec2* residuals,
                        float* weights, int iterations) {
  const auto pose = static_cast<std::size_t>(problem.pose_unknowns());
  problem.linearise(equations_);
  equations_.variances(step_);
  for (std::size_t k = 0; k < static_cast<std::size_t>(kPoseUnknowns); ++k)
    if (!(step_[k] > 0)) return Status::underdetermined;
  const Model& model = cascade_.model();
  if (sd != nullptr)
    for (std::size_t p = 0; p < model.parameters().count; ++p) {
      const std::uint16_t k = cascade_.column_of(p);
      sd[p] = k == kNone ? 0.0f : min(square_root(step_[pose + k]), model.parameters()[p].sd);
    }
  FitReport out;
  out.view = problem.view;
  out.iterations = iterations;
  out.undetermined = equations_.undetermined_count();
  const Projector projector(problem.view, true);
  float sum = 0;
  for (std::size_t i = 0; i < problem.points.count; ++i) {
    Vec2 x = problem.points[i].x;
    projector.project(cascade_.evaluate(baked_at(i), problem.q), &x);
    const Vec2 residual = x - problem.points[i].x;
    const float weight = problem.point_loss(problem.points[i], residual).weight;
    if (residuals != nullptr) residuals[i] = residual;
    if (weights != nullptr) weights[i] = weight;
    if (weight <= 0) continue;
    ++out.used;
    sum += dot(residual, residual);
  }
  if (out.used < 4) return Status::underdetermined;
  out.rms_px = square_root(sum / static_cast<float>(out.used));
  for (std::size_t p = 0; p < model.parameters().count; ++p) q[p] = problem.q[p];
  *report = out;
  return Status::ok;
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
