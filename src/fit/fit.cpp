// Shape and pose from correspondences (the paper, section 6; ALGORITHMS 4.4, 5.2, 5.6).
#include "pliant/fit.hpp"

#include "fit/fit_problem.hpp"

namespace pliant {

namespace {

constexpr int kStages = 3;
/// Points whose distances from one line are no larger than this, in their own deviations or as a share of their spread along it,
/// are on it.
constexpr float kLineSds = 2, kLineShare = 0.005f;
/// Matches of the outline a stage; between two of them the points it gave are held.
constexpr int kMatches = 3;
/// Times that a folded state is moved back: with rotations in the cascade the first may not be enough.
constexpr int kUnfoldings = 6;

Status check_points(Span<const Correspondence> points, const FitOptions& options) {
  if (options.width <= 0 || options.height <= 0 || !is_finite(options.focal_px) || options.focal_px < 0 ||
      !(options.stiffness >= 0))
    return Status::bad_argument;
  for (const Correspondence& c : points) {
    if (!is_finite(c.x) || !is_finite(c.uv) || !is_finite(c.sd_px) || !(c.sd_px > 0))
      return Status::bad_argument;
    if (c.uv.x < 0 || c.uv.x > 1 || c.uv.y < 0 || c.uv.y > 1) return Status::bad_argument;
  }
  return Status::ok;
}

/// True where the points lie on one line of the picture, as far as their noise lets one tell: it could be the image of the
/// surface from any side around that line.
bool lie_on_a_line(Span<const Correspondence> points) {
  const float share = 1.0f / static_cast<float>(points.count);
  Vec2 mean;
  float sd = 0;
  for (const Correspondence& c : points) {
    mean = mean + share * c.x;
    sd += share * c.sd_px;
  }
  Sym2 spread;
  for (const Correspondence& c : points) {
    const Vec2 d = c.x - mean;
    spread.xx += share * d.x * d.x;
    spread.xy += share * d.x * d.y;
    spread.yy += share * d.y * d.y;
  }
  const float half = 0.5f * (spread.xx + spread.yy), off = 0.5f * (spread.xx - spread.yy);
  const float root = square_root(off * off + spread.xy * spread.xy);
  const float least = max(kLineSds * sd, kLineShare * square_root(half + root));
  return half - root <= least * least;
}

}  // namespace

void Fitter::lay_out(Arena& arena, const Model& model, const FitLimits& limits) {
  limits_ = limits;
  cascade_.lay_out(arena, model);
  const std::size_t parameters = model.parameters().count, unknowns = parameters + kPoseUnknownsWithFocal;
  equations_.lay_out(arena, unknowns);
  baked_ = arena.take<Vec3>(std::size_t{limits.points} * model.cascade().count);
  position_ = arena.take<Vec3>(limits.points);
  ideal_ = arena.take<Correspondence>(limits.points);
  sorted_ = arena.take<float>(limits.points);
  step_ = arena.take<float>(3 * unknowns);  // the scratch of `integrate`
  trial_q_ = arena.take<float>(parameters);
  start_q_ = arena.take<float>(parameters);
  unknown_ = arena.take<std::uint16_t>(unknowns);
  column_ = arena.take<Vec2>(unknowns);
  fold_over_.lay_out(arena, model);
  valid_ = arena.take<Vec3>(model.base_uv().count);
  trial_ = arena.take<Vec3>(model.base_uv().count);
  valid_q_ = arena.take<float>(parameters);
  silhouette_normal_ = nullptr;
  if (limits.silhouette) lay_out_silhouette(arena, model);
}

Status Fitter::fit_ideal(Span<const Correspondence> points, const FitOptions& options, float* q,
                         FitReport* report, float* sd, Vec2* residuals, float* weights) {
  if (q == nullptr || report == nullptr) return Status::bad_argument;
  const Status checked = check_points(points, options);
  if (checked != Status::ok) return checked;
  if (points.count > limits_.points) return Status::capacity;
  if (points.count < 4) return Status::too_few_points;
  if (lie_on_a_line(points)) return Status::underdetermined;
  const std::size_t parameters = cascade_.parameter_count();
  for (std::size_t i = 0; i < parameters; ++i)
    if (!is_finite(q[i])) return Status::bad_argument;
  bool has_silhouette = false;
  for (const Correspondence& c : points) has_silhouette = has_silhouette || c.is_silhouette;
  if (has_silhouette && !limits_.silhouette) return Status::bad_argument;
  if (limits_.silhouette) {
    const Status started = start_silhouette();
    if (started != Status::ok) return started;
  }

  if (options.is_free != nullptr)
    cascade_.set_free(options.is_free);
  else
    cascade_.set_all_free();
  if (!fold_over_.is_started()) fold_over_.start(cascade_);
  for (std::size_t i = 0; i < parameters; ++i) start_q_[i] = q[i];
  for (std::size_t i = 0; i < points.count; ++i) {
    cascade_.sample_point(points[i].uv, q, samples_at(i));
    position_[i] = cascade_.evaluate(samples_at(i), q);
  }

  FitProblem problem{*this, points, options, start_q_};
  const auto larger = static_cast<float>(options.width > options.height ? options.width : options.height);
  problem.prior_focal = options.focal_px > 0 ? options.focal_px : options.default_focal_ratio * larger;
  const Camera camera = options.camera != nullptr
                            ? *options.camera
                            : centred_camera(options.width, options.height, problem.prior_focal);
  if (options.start != nullptr) {
    problem.view = *options.start;
  } else {
    problem.shape_is_free = false;
    find_start(problem, position_, {camera.cx, camera.cy});
    problem.shape_is_free = true;
  }
  problem.focal_is_known = options.focal_px > 0;
  const int iterations = minimise_in_stages(problem, has_silhouette);
  return conclude(problem, q, report, sd, residuals, weights, iterations);
}

/// Moves the free parameters back, where they fold the surface, towards where it was last known not to be folded.
/// \return whether it had to.
bool Fitter::undo_fold_over(FitProblem& problem) {
  const std::size_t parameters = cascade_.parameter_count();
  bool moved_back = false;
  for (int k = 0; k < kUnfoldings; ++k) {
    fold_over_.compute_positions(cascade_, problem.q, trial_);
    float share = fold_over_.step_fraction(valid_, trial_);
    if (share == 1) break;
    if (k + 1 == kUnfoldings) share = 0;
    for (std::size_t i = 0; i < parameters; ++i)
      problem.q[i] = valid_q_[i] + share * (problem.q[i] - valid_q_[i]);
    moved_back = true;
  }
  for (std::size_t i = 0; i < parameters; ++i) valid_q_[i] = problem.q[i];
  fold_over_.compute_positions(cascade_, valid_q_, valid_);
  return moved_back;
}

int Fitter::minimise_in_stages(FitProblem& problem, bool has_silhouette) {
  const FitOptions& options = problem.options;
  const int matches = has_silhouette ? kMatches : 1;
  int iterations = 0;
  // The frozen parameters are what they are; a start that the free ones fold goes back towards the model at rest.
  for (std::size_t i = 0; i < cascade_.parameter_count(); ++i)
    valid_q_[i] = cascade_.column_of(i) == kNone ? problem.q[i] : 0.0f;
  fold_over_.compute_positions(cascade_, valid_q_, valid_);
  undo_fold_over(problem);
  for (int stage = 0; stage < kStages; ++stage)
    for (int k = 0; k < matches; ++k) {
      if (has_silhouette) match_silhouette(problem);
      problem.loss = !options.robust ? Loss::squares : stage == kStages - 1 ? Loss::tukey : Loss::huber;
      if (options.robust) problem.update_scale();
      const int most = options.iterations / (kStages * matches);
      iterations += problem.minimise(most).iterations;
      if (!undo_fold_over(problem)) continue;
      problem.shape_is_free = false;  // the pose follows
      iterations += problem.minimise(most).iterations;
      problem.shape_is_free = true;
    }
  return iterations;
}

Status Fitter::conclude(FitProblem& problem, float* q, FitReport* report, float* sd, Vec2* residuals,
                        float* weights, int iterations) {
  const std::size_t pose = problem.pose_unknowns();
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
  for (std::size_t k = 0; k < pose; ++k) out.pose_sd[k] = square_root(step_[k]);
  out.view = problem.view;
  out.iterations = iterations;
  out.undetermined = equations_.undetermined_count();
  const Projector projector(problem.view, true);
  float sum = 0;
  for (std::size_t i = 0; i < problem.points.count; ++i) {
    Vec2 x = problem.points[i].x;
    projector.project(cascade_.evaluate(samples_at(i), problem.q), &x);
    const Vec2 residual = problem.counted(i, x - problem.points[i].x);
    const float weight = problem.point_loss(i, residual).weight;
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

}  // namespace pliant
