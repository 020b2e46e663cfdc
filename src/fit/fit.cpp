// The fit of one image: initial view, stages of minimisation, report.
#include "pliant/fit.hpp"

#include "base/arrays.hpp"
#include "base/integers.hpp"
#include "base/symmetric.hpp"
#include "fit/fit_problem.hpp"
#include "fit/fit_start.hpp"
#include "fit/fit_tuning.hpp"
#include "fit/fold_over_guard.hpp"
#include "fit/other_solutions.hpp"
#include "fit/silhouette_matcher.hpp"
#include "model/chart.hpp"
#include "pliant/lens.hpp"

namespace pliant {

struct Fitter::State {
  FitLimits limits;
  FitWorkspace work;
  FoldOverGuard fold_over;
  OtherSolutions others;
  SilhouetteMatcher* silhouette = nullptr;  // null without limits.silhouette
  Vec3* position = nullptr;                 // a point, while the shape is held
  Correspondence* ideal = nullptr;          // the points without the lens
  float* q = nullptr;                       // the present parameters
  float* first_q = nullptr;                 // those that the stages begin with

  void lay_out(Arena& arena, const Model& model, const FitLimits& most);
  Status fit(Span<const Correspondence> points, const FitOptions& options, float* result, FitReport* report,
             const FitDetails& details);
  void start(FitProblem& problem);
  int minimise(FitProblem& problem, bool has_silhouette);
  int minimise_in_stages(FitProblem& problem, bool has_silhouette, bool moves_back);
  bool match_silhouette(const FitProblem& problem);
  const float* variances(FitProblem& problem, float information);
  void write_deviations(const float* variance, float* sd) const;
  Status finish(FitProblem& problem, FitReport* report, const FitDetails& details);
};

namespace {

Status check_points(Span<const Correspondence> points, const FitOptions& options) {
  if (options.width <= 0 || options.height <= 0 || !is_finite(options.focal_px) || options.focal_px < 0 ||
      !(options.stiffness >= 0) || !(options.misfit_mm >= 0))
    return Status::bad_argument;
  const EulerOptions& euler = options.euler;
  if (!(euler.delta > 0) || euler.steps < 0 || !(euler.relative_decrease >= 0)) return Status::bad_argument;
  if (options.start != nullptr && !is_possible(pose_of(*options.start), camera_of(*options.start)))
    return Status::bad_argument;
  for (const Correspondence& c : points) {
    const bool is_near = magnitude(c.x.x) <= kFarthestPx && magnitude(c.x.y) <= kFarthestPx;
    if (!is_near || !is_in_chart(c.uv) || !is_finite(c.sd_px) || !(c.sd_px > 0)) return Status::bad_argument;
  }
  return Status::ok;
}

/// Whether the points lie on one line of the image, within their noise. The view could then be turned about that line.
bool lie_on_a_line(Span<const Correspondence> points) {
  const float fraction = 1.0f / static_cast<float>(points.count);
  Vec2 mean;
  float sd = 0;
  for (const Correspondence& c : points) {
    mean = mean + fraction * c.x;
    sd += fraction * c.sd_px;
  }
  Sym2 spread;
  for (const Correspondence& c : points) {
    const Vec2 d = c.x - mean;
    spread.xx += fraction * d.x * d.x;
    spread.xy += fraction * d.x * d.y;
    spread.yy += fraction * d.y * d.y;
  }
  const Eigenvalues across_and_along = eigenvalues(spread);
  const float least =
      max(kFitTuning.line_sds * sd, kFitTuning.line_fraction * square_root(across_and_along.largest));
  return across_and_along.smallest <= least * least;
}

bool has_silhouette_points(Span<const Correspondence> points) {
  for (const Correspondence& c : points)
    if (c.is_silhouette) return true;
  return false;
}

}  // namespace

void Fitter::State::lay_out(Arena& arena, const Model& model, const FitLimits& most) {
  limits = most;
  work.lay_out(arena, model, limits.points);
  position = arena.take<Vec3>(limits.points);
  ideal = arena.take<Correspondence>(limits.points);
  q = arena.take<float>(model.parameters().count);
  first_q = arena.take<float>(model.parameters().count);
  fold_over.lay_out(arena, model, limits.samples_base_mesh);
  others.lay_out(arena, model);
  if (!limits.silhouette) return;
  silhouette = create_part<SilhouetteMatcher>(arena, model);
  work.contour_normal = arena.take<Vec2>(limits.points);
}

void Fitter::lay_out(Arena& arena, const Model& model, const FitLimits& limits) {
  state_ = create_part<State>(arena, model, limits);
}

Cascade& Fitter::cascade() {
  return state_->work.cascade;
}

bool Fitter::has_slid(std::size_t point) const {
  PLIANT_ASSERT(point < state_->limits.points);
  const Vec2* const normal = state_->work.contour_normal;
  return normal != nullptr && dot(normal[point], normal[point]) > 0;
}

/// The fit itself has no lens: points are undistorted before it, residuals distorted after it.
Status Fitter::fit(Span<const Correspondence> points, const FitOptions& options, float* q, FitReport* report,
                   const FitDetails& details) {
  if (state_ == nullptr) return Status::capacity;
  if (points.data == nullptr && points.count > 0) return Status::bad_argument;
  State& s = *state_;
  if (options.camera == nullptr) return s.fit(points, options, q, report, details);
  Lens lens;
  Status status = Lens::make(*options.camera, options.width, options.height, &lens);
  if (status != Status::ok) return status;
  if (points.count > s.limits.points) return Status::capacity;
  for (std::size_t i = 0; i < points.count; ++i) {
    s.ideal[i] = points[i];
    if (is_finite(points[i].x)) s.ideal[i].x = lens.undistort(points[i].x);
  }
  FitOptions known = options;
  known.focal_px = options.camera->f;
  status = s.fit({s.ideal, points.count}, known, q, report, details);
  if (status != Status::ok || details.residuals == nullptr) return status;
  for (std::size_t i = 0; i < points.count; ++i)
    details.residuals[i] = lens.distort(s.ideal[i].x + details.residuals[i]) - points[i].x;
  return status;
}

Status Fitter::State::fit(Span<const Correspondence> points, const FitOptions& options, float* result,
                          FitReport* report, const FitDetails& details) {
  const bool has_values = result != nullptr || work.cascade.parameter_count() == 0;
  if (!has_values || report == nullptr) return Status::bad_argument;
  const Status checked = check_points(points, options);
  if (checked != Status::ok) return checked;
  if (points.count > limits.points) return Status::capacity;
  if (points.count < kLeastFitPoints) return Status::too_few_points;
  if (lie_on_a_line(points)) return Status::underdetermined;
  Cascade& cascade = work.cascade;
  const std::size_t parameters = cascade.parameter_count();
  if (!are_finite(result, parameters)) return Status::bad_argument;
  const bool has_silhouette = has_silhouette_points(points);
  if (has_silhouette && !limits.silhouette) return Status::bad_argument;
  if (has_silhouette) {
    const Status started = silhouette->start(cascade.model());
    if (started != Status::ok) return started;
  }
  copy(result, parameters, q);
  FitProblem problem{work, points, options, q};
  start(problem);
  others.start(q);
  FitReport out;
  out.iterations = minimise(problem, has_silhouette);
  if (options.start == nullptr && others.find_better(problem, fold_over))
    out.iterations += minimise(problem, has_silhouette);
  const Status status = finish(problem, &out, details);
  if (status != Status::ok) return status;
  copy(q, parameters, result);
  *report = out;
  return Status::ok;
}

/// Chooses the unknowns, samples the points and finds the initial view.
void Fitter::State::start(FitProblem& problem) {
  const FitOptions& options = problem.options;
  Cascade& cascade = work.cascade;
  if (options.is_free != nullptr)
    cascade.set_free(options.is_free);
  else
    cascade.set_all_free();
  for (std::size_t k = 0; k < cascade.column_count(); ++k) {
    const std::uint16_t p = cascade.parameter_of(k);
    q[p] = stepped(cascade.model().parameters()[p], q[p], 0);
  }
  for (std::size_t i = 0; limits.silhouette && i < limits.points; ++i) work.contour_normal[i] = {};
  for (std::size_t i = 0; i < problem.points.count; ++i)
    cascade.sample_point(problem.points[i].uv, q, work.samples_of(i));
  const auto side = static_cast<float>(larger(options.width, options.height));
  problem.prior_focal = options.focal_px > 0 ? options.focal_px : kDefaultFocalRatio * side;
  if (options.start != nullptr) {
    problem.view = *options.start;
  } else {
    const Camera camera = options.camera != nullptr
                              ? *options.camera
                              : centred_camera(options.width, options.height, problem.prior_focal);
    problem.hold_shape(position);
    find_initial_view(problem, {camera.cx, camera.cy});
    problem.held_position = nullptr;
  }
  problem.focal_is_known = options.focal_px > 0;
}

/// Few fits fold the surface over. Only where the result does is the fit made again, with a test after each stage.
/// \return iterations.
int Fitter::State::minimise(FitProblem& problem, bool has_silhouette) {
  const std::size_t parameters = work.cascade.parameter_count();
  const View view = problem.view;
  copy(problem.q, parameters, first_q);
  fold_over.start(work.cascade, problem.q);
  const int iterations = minimise_in_stages(problem, has_silhouette, false);
  if (!fold_over.has_folded(problem.q)) return iterations;
  problem.view = view;
  copy(first_q, parameters, problem.q);
  return iterations + minimise_in_stages(problem, has_silhouette, true);
}

/// \param moves_back  a stage that folds the surface over is moved back towards where it began.
int Fitter::State::minimise_in_stages(FitProblem& problem, bool has_silhouette, bool moves_back) {
  const FitOptions& options = problem.options;
  const int stages = kFitTuning.stages, matches = has_silhouette ? kFitTuning.silhouette_matches : 1;
  const int each = options.iterations / (stages * matches), most = each > 0 ? each : 1;
  int iterations = 0;
  if (moves_back) {
    fold_over.expect_shapes();
    fold_over.move_back(problem.q);
  }
  for (int stage = 0; stage < stages; ++stage)
    for (int k = 0; k < matches; ++k) {
      const bool slides = has_silhouette && match_silhouette(problem);
      problem.loss = !options.robust ? Loss::squares : stage == stages - 1 ? Loss::tukey : Loss::huber;
      if (options.robust) problem.update_scale();
      iterations += problem.minimise(most).iterations;
      if (!moves_back || !(slides || k + 1 == matches) || !fold_over.move_back(problem.q)) continue;
      problem.hold_shape(position);  // the pose follows
      iterations += problem.minimise(most).iterations;
      problem.held_position = nullptr;
    }
  return iterations;
}

/// \return whether a landmark is away from its own place.
bool Fitter::State::match_silhouette(const FitProblem& problem) {
  const Projector projector(problem.view, true);
  bool has_contour = false, slides = false;
  for (std::size_t i = 0; i < problem.points.count; ++i) {
    const Correspondence& landmark = problem.points[i];
    if (!landmark.is_silhouette) continue;
    SilhouetteMatch match{landmark.uv, {}};
    if (SilhouetteMatcher::is_turned_away(work.cascade, problem.q, projector, landmark.uv)) {
      if (!has_contour) {
        fold_over.expect_shapes();
        fold_over.see(problem.q);
        silhouette->find_contour(fold_over.positions(), projector);
      }
      has_contour = true;
      match = silhouette->nearest(landmark);
    }
    work.contour_normal[i] = match.normal;
    slides = slides || dot(match.normal, match.normal) > 0;
    work.cascade.sample_point(match.uv, problem.q, work.samples_of(i));
  }
  return slides;
}

/// Of the unknowns. \param information  FitProblem::information. \return valid until the next call.
const float* Fitter::State::variances(FitProblem& problem, float information) {
  problem.information = information;
  problem.linearise(work.equations);
  work.equations.variances(work.step);
  return work.step;
}

/// \param variance  of the columns. \param sd  out, of each parameter; null: not wanted.
void Fitter::State::write_deviations(const float* variance, float* sd) const {
  const auto parameters = work.cascade.model().parameters();
  for (std::size_t p = 0; sd != nullptr && p < parameters.count; ++p) {
    const std::uint16_t k = work.cascade.column_of(p);
    const float of_fit = k == kNone ? 0.0f : variance[k];  // 0 also where nothing determines it
    sd[p] = k == kNone ? 0.0f : of_fit > 0 ? min(square_root(of_fit), parameters[p].sd) : parameters[p].sd;
  }
}

/// Writes standard deviations, residuals and counts of the accepted state.
/// \return underdetermined if an unknown of the pose has no variance or fewer than kLeastFitPoints have weight; `details` is
///         then unchanged.
Status Fitter::State::finish(FitProblem& problem, FitReport* report, const FitDetails& details) {
  const std::size_t pose = problem.pose_unknowns();
  // With the model's own error.
  const float* const variance = variances(problem, 1 / (problem.scale * problem.scale));
  for (std::size_t k = 0; k < static_cast<std::size_t>(kPoseUnknowns); ++k)
    if (!(variance[k] > 0)) return Status::underdetermined;
  const Projector projector(problem.view, true);
  float sum = 0;
  for (std::size_t i = 0; i < problem.points.count; ++i) {
    const Vec2 residual = problem.residual(i, projector);
    if (problem.point_loss(i, residual).weight <= 0) continue;
    ++report->used;
    sum += dot(residual, residual);
  }
  if (report->used < kLeastFitPoints) return Status::underdetermined;
  report->rms_px = square_root(sum / static_cast<float>(report->used));
  report->view = problem.view;
  report->undetermined = work.equations.undetermined_count();
  for (std::size_t k = 0; k < pose; ++k) report->pose_sd[k] = square_root(variance[k]);
  write_deviations(variance + pose, details.sd);
  if (details.point_sd != nullptr) write_deviations(variances(problem, 1) + pose, details.point_sd);
  for (std::size_t i = 0; i < problem.points.count; ++i) {
    const Vec2 residual = problem.residual(i, projector);
    if (details.residuals != nullptr) details.residuals[i] = residual;
    if (details.weights != nullptr) details.weights[i] = problem.point_loss(i, residual).weight;
  }
  return Status::ok;
}

}  // namespace pliant
