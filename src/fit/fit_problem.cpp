#include "fit/fit_problem.hpp"

#include "base/arrays.hpp"
#include "base/elementary.hpp"
#include "fit/fit_tuning.hpp"

namespace pliant {

namespace {

float log_ratio(float a, float b) {
  return static_cast<float>(natural_log(static_cast<double>(a) / static_cast<double>(b)));
}

}  // namespace

void FitWorkspace::lay_out(Arena& arena, const Model& model, std::size_t points) {
  const std::size_t parameters = model.parameters().count, unknowns = parameters + kPoseUnknownsWithFocal;
  cascade.lay_out(arena, model);
  equations.lay_out(arena, unknowns);
  samples = arena.take<Vec3>(points * model.cascade().count);
  distance = arena.take<float>(points);
  step = arena.take<float>(3 * unknowns);  // the scratch of `integrate`
  trial_q = arena.take<float>(parameters);
  row.lay_out(arena, unknowns);
  contour_normal = nullptr;
}

Vec2 FitProblem::counted(std::size_t point, Vec2 residual) const {
  const Vec2 n = work.contour_normal != nullptr ? work.contour_normal[point] : Vec2{};
  return n.x == 0 && n.y == 0 ? residual : dot(n, residual) * n;
}

Vec2 FitProblem::residual(std::size_t point, const Projector& projector) const {
  const Vec2 observed = points[point].x;
  Vec2 x = observed + Vec2{1e6f, 1e6f};
  projector.project(position(point, q), &x);
  return counted(point, x - observed);
}

void FitProblem::hold_shape(Vec3* at) {
  held_position = nullptr;
  for (std::size_t i = 0; i < points.count; ++i) at[i] = position(i, q);
  held_position = at;
}

/// log(f / expected f), where f = s / rho.
float FitProblem::focal_log(const View& v) const {
  return log_ratio(v.s, v.rho * prior_focal);
}

float FitProblem::prior_cost(const float* parameters, const View& v) const {
  float cost = 0;
  for (std::size_t k = 0; k < columns(); ++k) {
    const float z = parameters[work.cascade.parameter_of(k)] / parameter(k).sd;
    cost += 0.5f * options.stiffness * z * z;
  }
  if (!focal_is_known) {
    const float z = focal_log(v) / kFitTuning.focal_log_sd;
    cost += 0.5f * z * z;
  }
  return cost;
}

float FitProblem::cost(const float* parameters, const View& v) const {
  const Projector projector(v, focal_is_known);
  float sum = 0;
  for (std::size_t i = 0; i < points.count; ++i) {
    Vec2 x;
    if (!projector.project(position(i, parameters), &x)) return 1e30f;
    sum += point_loss(i, points[i].x - x).rho;
  }
  return scale * scale * sum + prior_cost(parameters, v);
}

void FitProblem::add_point(NormalEquations& equations, std::size_t point, const Projector::Derivatives& d,
                           const Jacobian& jacobian, Vec2 residual, float weight) {
  const float w = information * weight / (points[point].sd_px * points[point].sd_px);
  const Vec2 across = counted(point, {1, 0}), down = counted(point, {0, 1});  // the columns of n n^T, or of I
  work.row.add_to(equations, {d.pose, pose_unknowns()}, d, jacobian, residual,
                  {w * across.x, w * across.y, w * down.y});
}

float FitProblem::linearise(NormalEquations& equations) {
  equations.reset(pose_unknowns() + columns());
  const Projector projector(view, focal_is_known);
  float sum = 0;
  for (std::size_t i = 0; i < points.count; ++i) {
    Jacobian jacobian;
    const Vec3 p =
        is_shape_free() ? work.cascade.evaluate(work.samples_of(i), q, &jacobian) : held_position[i];
    Vec2 x;
    Projector::Derivatives d;
    if (!projector.project(p, &x, &d)) continue;
    const Vec2 residual = points[i].x - x;
    const LossValue value = point_loss(i, residual);
    sum += value.rho;
    if (value.weight > 0) add_point(equations, i, d, jacobian, residual, value.weight);
  }
  add_priors(equations);
  return scale * scale * sum + prior_cost(q, view);
}

void FitProblem::add_priors(NormalEquations& equations) {
  const std::size_t pose = pose_unknowns();
  for (std::size_t k = 0; k < columns(); ++k)
    add_prior(parameter(k), q[work.cascade.parameter_of(k)], options.stiffness, pose + k, equations);
  for (std::size_t k = 0; k < 3; ++k)
    equations.set_limits(k, -kFitTuning.max_turn_rad, kFitTuning.max_turn_rad);
  equations.set_limits(kLogScale, -kFitTuning.max_log_step, kFitTuning.max_log_step);
  if (focal_is_known) return;
  equations.set_limits(kLogRho, -kFitTuning.max_log_step, kFitTuning.max_log_step);
  // A prior on log f = log s - log rho, around the expected focal length.
  const std::uint16_t pair[2] = {kLogScale, kLogRho};
  const Vec2 row[2] = {{1, 0}, {-1, 0}};
  const float w = 1.0f / (kFitTuning.focal_log_sd * kFitTuning.focal_log_sd);
  equations.add(pair, row, 2, {-focal_log(view), 0}, {w, 0, 0});
}

float FitProblem::try_step(const float* step) {
  trial = moved(view, step, static_cast<int>(pose_unknowns()));
  float* next = work.trial_q;
  copy(q, work.cascade.parameter_count(), next);
  for (std::size_t k = 0; k < columns(); ++k) {
    float& value = next[work.cascade.parameter_of(k)];
    value = stepped(parameter(k), value, step[pose_unknowns() + k]);
  }
  return cost(next, trial);
}

void FitProblem::accept() {
  view = trial;
  copy(work.trial_q, work.cascade.parameter_count(), q);
}

SolverReport FitProblem::minimise(int iterations) {
  const LeastSquaresProblem problem{
      this, [](void* p, NormalEquations& e) { return static_cast<FitProblem*>(p)->linearise(e); },
      [](void* p, const float* s) { return static_cast<FitProblem*>(p)->try_step(s); },
      [](void* p) { static_cast<FitProblem*>(p)->accept(); }};
  if (is_shape_free() && options.method == FitMethod::euler)
    return integrate(problem, options.euler, work.equations, work.step);
  SolverOptions solver;
  solver.max_accepted = iterations;
  return pliant::minimise(problem, solver, work.equations, work.step);
}

void FitProblem::update_scale() {
  const Projector projector(view, focal_is_known);
  float mean_sd = 0;
  for (std::size_t i = 0; i < points.count; ++i) {
    work.distance[i] = length(residual(i, projector)) / points[i].sd_px;
    mean_sd += points[i].sd_px / static_cast<float>(points.count);
  }
  const float misfit = options.misfit_mm * view.s / mean_sd;
  scale = max(robust_scale(work.distance, points.count), square_root(1 + misfit * misfit));
}

}  // namespace pliant
