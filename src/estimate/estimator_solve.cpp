// The estimator's solve: which observations take part, in which order losses and rejection are applied (ALGORITHMS 6.5),
// and what is left of them in the end.
#include "estimate/estimator_problem.hpp"

namespace pliant {

namespace {

constexpr std::size_t kFewestEquations = kPoseUnknowns + 4;
constexpr float kLeastWeight = 0.1f;  // of an inlier
constexpr int kIterationsAfter = 3;
constexpr float kMostFar = 0.03f;     // share of the rows
constexpr float kNearEnough = 0.02f;  // of the cost: a decrease at which Huber's loss gives way to Tukey's
constexpr float kLeastPivot = 1e-4f;
constexpr float kMostCueScale = 4;

/// W (I + s^2 W)^-1: the information that is left when an error of deviation s is added. Keeps rank one.
Sym2 with_added_error(Sym2 w, float s) {
  const float s2 = s * s;
  const float a = 1 + s2 * w.xx, b = s2 * w.xy, d = 1 + s2 * w.yy;
  const float inverse = 1.0f / (a * d - b * b);
  return {inverse * (w.xx * d - w.xy * b), inverse * (w.xy * a - w.xx * b), inverse * (w.yy * a - w.xy * b)};
}

/// Rank one, or so near to it that one direction weighs less than a thousandth of the other.
bool is_line(Sym2 w) {
  const float trace = w.xx + w.yy;
  return w.xx * w.yy - w.xy * w.xy <= 1e-3f * trace * trace;
}

}  // namespace

/// An observation's information with the cue's own error added, in the cue's scale.
Sym2 Estimator::informed(const Observation& o) const {
  const auto cue = static_cast<std::size_t>(o.cue);
  const float mm = o.cue == Cue::edge ? options_.edge_error_mm : options_.model_error_mm;
  const Sym2 w = with_added_error(o.information, mm * expected_view_.s);
  const float share = 1.0f / (cue_scale_[cue] * cue_scale_[cue]);
  return {share * w.xx, share * w.xy, share * w.yy};
}

bool Estimator::is_usable(const Observation& o) const {
  const Sym2 w = o.information;
  return has_point(o.id) && static_cast<std::size_t>(o.cue) < kCueCount && is_finite(o.x) &&
         is_finite(w.xx) && is_finite(w.xy) && is_finite(w.yy) && w.xx >= 0 && w.yy >= 0 && w.xx + w.yy > 0;
}

/// Makes rows of the observations that take part: neighbours with one id are one row. Counts what was looked for.
void Estimator::gather(Span<Observation> observations) {
  row_count_ = 0;
  looked_for_ = patches_looked_for_ = 0;
  std::size_t equations = 0;
  for (std::size_t k = 0; k < observations.count && k < kNone;) {
    const std::size_t first = k;
    bool was_looked_for = false, is_patch = false;
    std::uint16_t good = 0;
    Observation* alternative = nullptr;
    for (; k < observations.count && observations[k].id == observations[first].id && k - first < 255; ++k) {
      Observation& o = observations[k];
      was_looked_for = was_looked_for || o.reason != Reason::not_visible;
      is_patch = is_patch || (o.reason != Reason::not_visible && o.cue == Cue::patch);
      if (o.reason != Reason::found && o.reason != Reason::rejected) continue;
      o.reason = is_usable(o) && row_count_ < limits_.points ? Reason::found : Reason::not_visible;
      if (o.reason == Reason::found && !options_.uses(o.cue)) o.reason = Reason::rejected;
      if (o.reason != Reason::found) continue;
      ++good;
      alternative = &o;
    }
    looked_for_ += was_looked_for;
    patches_looked_for_ += is_patch;
    if (good == 0) continue;
    Row& row = rows_[row_count_];
    row = {alternative->id,
           static_cast<std::uint16_t>(first),
           static_cast<std::uint8_t>(k - first),
           0,
           alternative->cue,
           true,
           is_line(alternative->information)};
    information_[row_count_++] = informed(*alternative);
    equations += row.is_line ? 1 : 2;
  }
  has_enough_ = equations >= kFewestEquations;
}

SolverReport Estimator::solve(Span<Observation> observations) {
  if (lens_.is_none()) return solve_ideal(observations);
  undistort(observations);
  const SolverReport report = solve_ideal(observations);
  distort(observations);
  return report;
}

bool Estimator::solve_first_pass(Span<Observation> observations) {
  had_first_pass_ = needs_another_round_ = false;
  if (!lens_.is_none()) undistort(observations);
  had_first_pass_ = started_ && solve_first_pass_ideal(observations);
  if (!lens_.is_none()) distort(observations);
  return had_first_pass_;
}

bool Estimator::solve_first_pass_ideal(Span<Observation> observations) {
  gather(observations);
  if (!has_enough_ || 2 * row_count_ < looked_for_) return false;
  for (std::size_t i = 0; i < cascade_.parameter_count(); ++i) alternative_q_[i] = q_[i];
  EstimatorProblem problem(*this, observations, view_);
  SolverReport report;
  problem.measure();
  settle_by_weights(problem, &report);
  result_.iterations = static_cast<std::uint16_t>(result_.iterations + report.iterations);
  if (!is_doubtful(problem) && pose_is_observed()) {
    view_ = problem.view;
    return true;
  }
  for (std::size_t i = 0; i < cascade_.parameter_count(); ++i) q_[i] = alternative_q_[i];
  return false;
}

SolverReport Estimator::solve_ideal(Span<Observation> observations) {
  SolverReport report;
  row_count_ = 0;
  if (started_) gather(observations);
  result_.tracked = static_cast<std::uint16_t>(row_count_);
  result_.inliers = 0;
  if (row_count_ == 0 || !has_enough_) {
    row_count_ = 0;
    return report;
  }
  EstimatorProblem problem(*this, observations, view_);
  problem.measure_as_predicted();
  if (options_.rejection == Rejection::none)
    problem.minimise(options_.iterations, options_.relative_decrease, &report);
  else
    solve_robustly(problem, &report);
  view_ = problem.view;
  result_.iterations = static_cast<std::uint16_t>(result_.iterations + report.iterations);
  conclude(problem);
  return report;
}

/// Huber's loss finds the way from where Tukey's would hold on to what happens to be near. Nothing of that is needed after
/// an approach, unless a part has moved by itself of which the few points knew nothing, a jaw that drops.
void Estimator::settle_by_weights(EstimatorProblem& problem, SolverReport* report) {
  if (had_first_pass_) {
    problem.update_scale();
    needs_another_round_ = far_fraction(problem) > kMostFar;
  }
  if (!had_first_pass_ || needs_another_round_)
    problem.settle(Loss::huber, options_.iterations, kNearEnough, report);
  problem.settle(Loss::tukey, options_.iterations, options_.relative_decrease, report);
}

void Estimator::solve_robustly(EstimatorProblem& problem, SolverReport* report) {
  const Rejection rejection = options_.rejection;
  if (solves_++ > 0) {
    if (rejected_forces_) keep_as_before(problem);
    problem.settle(Loss::tukey, options_.iterations, options_.relative_decrease, report);
  } else if (rejection == Rejection::forces || rejection == Rejection::forces_readmitted) {
    solve_by_forces(problem, report);
  } else {
    settle_by_weights(problem, report);
    if (rejection == Rejection::on_doubt && is_doubtful(problem)) problem.try_alternative(report);
  }
}

void Estimator::solve_by_forces(EstimatorProblem& problem, SolverReport* report) {
  rejected_forces_ = true;
  if (sample_capacity_ > 0) limits_.rejection->reject(problem);
  problem.settle(Loss::huber, options_.iterations, kNearEnough, report);
  problem.settle(Loss::tukey, options_.iterations, options_.relative_decrease, report);
  if (options_.rejection == Rejection::forces) return;
  problem.readmit();
  problem.minimise(kIterationsAfter, options_.relative_decrease, report);
}

/// Of the rows, those to which Tukey's loss gives no weight.
float Estimator::far_fraction(const EstimatorProblem& problem) const {
  std::size_t far = 0;
  for (std::size_t k = 0; k < row_count_; ++k)
    far += evaluate(Loss::tukey, lengths_[k] / problem.scale).weight <= kLeastWeight;
  return static_cast<float>(far) / static_cast<float>(row_count_);
}

/// Residuals well above what the cues have had lately, or much without weight: coherent things on the surface look so.
bool Estimator::is_doubtful(const EstimatorProblem& problem) const {
  return problem.scale > options_.doubt_scale || far_fraction(problem) > options_.doubt_fraction;
}

/// In a later round: points that the round before let go have to fit first.
void Estimator::keep_as_before(EstimatorProblem& problem) {
  for (std::size_t k = 0; k < row_count_; ++k) rows_[k].is_kept = was_rejected_[rows_[k].id] == 0;
  problem.readmit();
}

/// Counts and marks what has weight at the end.
void Estimator::conclude(const EstimatorProblem& problem) {
  float square_sum = 0, score_sum = 0;
  std::uint16_t inliers = 0, scored = 0;
  patch_inliers_ = 0;
  for (std::size_t k = 0; k < row_count_; ++k) {
    const Row& row = rows_[k];
    const float u = lengths_[k] / problem.scale;
    const bool fits =
        row.is_kept && (problem.loss == Loss::squares || evaluate(Loss::tukey, u).weight > kLeastWeight);
    was_rejected_[row.id] = fits ? 0 : 1;
    Observation* const alternatives = &problem.observations[row.first];
    for (std::uint8_t i = 0; i < row.count; ++i)
      if (alternatives[i].reason == Reason::found && !(fits && i == row.chosen))
        alternatives[i].reason = Reason::rejected;
    alternatives[row.chosen].residual = residuals_[k];
    if (!fits) continue;
    ++inliers;
    square_sum += squared_px(k);
    if (row.cue != Cue::patch) continue;
    ++patch_inliers_;
    score_sum += alternatives[row.chosen].score;
    scored = static_cast<std::uint16_t>(scored + (alternatives[row.chosen].score != 0));
  }
  result_.inliers = inliers;
  result_.rms_px = inliers > 0 ? square_root(square_sum / static_cast<float>(inliers)) : 0.0f;
  result_.score = scored > 0 ? score_sum / static_cast<float>(scored) : 0.0f;
  result_.pose_is_observed = pose_is_observed();
}

/// Squared residual of a row, px^2: of a line's, what is across it.
float Estimator::squared_px(std::size_t row) const {
  const Sym2 w = information_[row];
  const Vec2 r = residuals_[row];
  if (!rows_[row].is_line) return dot(r, r);
  return (w.xx * r.x * r.x + 2 * w.xy * r.x * r.y + w.yy * r.y * r.y) / (w.xx + w.yy);
}

/// Whether the observations alone determine the rigid block: pivots of its scaled Cholesky, priors taken out.
bool Estimator::pose_is_observed() {
  float l[kPoseUnknowns][kPoseUnknowns];
  for (std::size_t j = 0; j < kPoseUnknowns; ++j) {
    const float diagonal = equations_.h(j, j) - 1.0f / pose_variance_[j];
    float pivot = diagonal;
    for (std::size_t k = 0; k < j; ++k) {
      l[j][k] = equations_.h(j, k);
      for (std::size_t m = 0; m < k; ++m) l[j][k] -= l[j][m] * l[k][m];
      l[j][k] /= l[k][k];
      pivot -= l[j][k] * l[j][k];
    }
    if (!(diagonal > 0) || !(pivot > kLeastPivot * diagonal)) return false;
    l[j][j] = square_root(pivot);
  }
  return true;
}

/// How far each cue's residuals really are from their own deviations, for the next frame (ALGORITHMS 7.6).
void Estimator::update_cue_scales() {
  constexpr std::size_t kFewestRows = 8;
  for (std::size_t c = 0; c < kCueCount; ++c) {
    std::size_t n = 0;
    for (std::size_t k = 0; k < row_count_; ++k)
      if (rows_[k].is_kept && rows_[k].cue == static_cast<Cue>(c)) sorted_[n++] = lengths_[k];
    if (n < kFewestRows) continue;
    const float seen = clamp(cue_scale_[c] * robust_scale(sorted_, n), 1, kMostCueScale);
    cue_scale_[c] += options_.cue_scale_rate * (seen - cue_scale_[c]);
  }
}

}  // namespace pliant
