// One frame's least squares (ALGORITHMS 5.2-5.6): forces f_i on surface points in the generalised force of Eq. 9, with
// the Gauss-Newton matrix of the same sum, priors and robust weights.
#include "estimate/estimator_problem.hpp"

namespace pliant {

namespace {

constexpr float kLineToPlane = 1.74559f;  // median of a Rayleigh variable over that of a half-normal one

float mahalanobis(Sym2 w, Vec2 r) {
  return square_root(w.xx * r.x * r.x + 2 * w.xy * r.x * r.y + w.yy * r.y * r.y);
}

}  // namespace

/// Residual and length of a row at a projected position; of alternatives, the nearest one.
void EstimatorProblem::choose(std::size_t row, Vec2 x) {
  Estimator::Row& r = e.rows_[row];
  float best = -1;
  for (std::uint8_t k = 0; k < r.count; ++k) {
    const Observation& o = observations[static_cast<std::size_t>(r.first) + k];
    if (o.reason != Reason::found) continue;
    const Sym2 w = r.count == 1 ? e.information_[row] : e.informed(o);
    const float length = mahalanobis(w, o.x - x) * (r.is_line ? kLineToPlane : 1.0f);
    if (best >= 0 && length >= best) continue;
    best = length;
    r.chosen = k;
    e.information_[row] = w;
    e.residuals_[row] = o.x - x;
  }
  e.lengths_[row] = best;
}

void EstimatorProblem::measure(const View& v, const float* q) {
  const Projector projector(v, true);
  for (std::size_t k = 0; k < e.row_count_; ++k) {
    Vec2 x = kBehind;
    projector.project(e.cascade_.evaluate(e.samples_of_point(e.rows_[k].id), q), &x);
    choose(k, x);
  }
}

void EstimatorProblem::measure() {
  measure(view, e.q_);
}

void EstimatorProblem::measure_as_predicted() {
  if (!e.is_predicted()) return measure();
  for (std::size_t k = 0; k < e.row_count_; ++k) {
    std::size_t first = 0, end = e.prediction_count_;  // in order of id
    while (end - first > 1) {
      const std::size_t middle = (first + end) / 2;
      (e.predictions_[middle].id <= e.rows_[k].id ? first : end) = middle;
    }
    choose(k, e.predictions_[first].x);
  }
}

void EstimatorProblem::update_scale() {
  std::size_t n = 0;
  for (std::size_t k = 0; k < e.row_count_; ++k)
    if (e.rows_[k].is_kept) e.sorted_[n++] = e.lengths_[k];
  scale = clamp(robust_scale(e.sorted_, n), 1, 8);
}

/// What of the expected view a view is away from, in the pose's unknowns.
void EstimatorProblem::pose_offset(const View& v, float (&offset)[kPoseUnknowns]) const {
  const Vec3 turn = log_rotation(e.expected_view_.q * conjugate(v.q));
  const float out[kPoseUnknowns] = {turn.x,
                                    turn.y,
                                    turn.z,
                                    (e.expected_view_.s - v.s) / v.s,
                                    e.expected_view_.tau.x - v.tau.x,
                                    e.expected_view_.tau.y - v.tau.y};
  for (int k = 0; k < kPoseUnknowns; ++k) offset[k] = out[k];
}

float EstimatorProblem::prior_cost(const View& v, const float* q) const {
  float offset[kPoseUnknowns], cost = 0;
  pose_offset(v, offset);
  for (int k = 0; k < kPoseUnknowns; ++k) cost += 0.5f * offset[k] * offset[k] / e.pose_variance_[k];
  for (std::size_t k = 0; k < e.cascade_.column_count(); ++k) {
    const std::uint16_t p = e.cascade_.parameter_of(k);
    const float z = q[p] / e.cascade_.model().parameters()[p].sd, t = (q[p] - e.expected_q_[p]) / e.sd_[p];
    cost += 0.5f * (e.options_.prior_strength * z * z + t * t);
  }
  return cost;
}

void EstimatorProblem::add_priors(const View& v, const float* q) const {
  NormalEquations& equations = e.equations_;
  float offset[kPoseUnknowns];
  pose_offset(v, offset);
  for (std::size_t k = 0; k < kPoseUnknowns; ++k)
    equations.add_prior(k, offset[k], 1.0f / e.pose_variance_[k]);
  for (std::size_t k = 0; k <= kLogScale; ++k) equations.set_limits(k, -0.3f, 0.3f);
  for (std::size_t k = 0; k < e.cascade_.column_count(); ++k) {
    const std::uint16_t p = e.cascade_.parameter_of(k);
    const Parameter& parameter = e.cascade_.model().parameters()[p];
    const std::size_t unknown = kPoseUnknowns + k;
    equations.add_prior(unknown, -q[p], e.options_.prior_strength / (parameter.sd * parameter.sd));
    equations.add_prior(unknown, e.expected_q_[p] - q[p], 1.0f / (e.sd_[p] * e.sd_[p]));
    equations.set_limits(unknown, min(parameter.minimum - q[p], 0), max(parameter.maximum - q[p], 0));
  }
}

void EstimatorProblem::add_row(const Projector::Derivatives& d, const Jacobian& jacobian, std::size_t row,
                               float weight) {
  std::size_t n = 0;
  for (; n < kPoseUnknowns; ++n) e.column_[n] = d.pose[n];
  for (std::size_t c = 0; c < jacobian.count; ++c, ++n) {
    e.unknown_[n] = static_cast<std::uint16_t>(kPoseUnknowns + jacobian.list[c]);
    e.column_[n] = d.along(jacobian.column[jacobian.list[c]]);
  }
  const Sym2 w = e.information_[row];
  e.equations_.add(e.unknown_, e.column_, n, e.residuals_[row],
                   {weight * w.xx, weight * w.xy, weight * w.yy});
}

/// Cost, residuals and normal equations at the accepted state.
float EstimatorProblem::linearise() {
  const View& v = view;
  const float* const q = e.q_;
  e.equations_.reset(kPoseUnknowns + e.cascade_.column_count());
  for (std::size_t n = 0; n < kPoseUnknowns; ++n) e.unknown_[n] = static_cast<std::uint16_t>(n);
  const Projector projector(v, true);
  const float per_scale = 1.0f / scale, share = per_scale * per_scale;
  float sum = 0;
  for (std::size_t k = 0; k < e.row_count_; ++k) {
    const Estimator::Row& r = e.rows_[k];
    Jacobian jacobian;
    const Vec3 p = e.cascade_.evaluate(e.samples_of_point(r.id), q, &jacobian);
    Vec2 x = kBehind;
    Projector::Derivatives d;
    const bool in_front = projector.project(p, &x, &d);
    choose(k, x);
    if (!r.is_kept) continue;
    const LossValue value = evaluate(loss, e.lengths_[k] * per_scale);
    sum += value.rho;
    if (in_front && value.weight > 0) add_row(d, jacobian, k, value.weight * share);
  }
  add_priors(v, q);
  return sum + prior_cost(v, q);
}

void EstimatorProblem::move(const float* step) {
  trial_ = moved(view, step, kPoseUnknowns);
  for (std::size_t k = 0; k < e.cascade_.column_count(); ++k) {
    const std::uint16_t p = e.cascade_.parameter_of(k);
    const Parameter& parameter = e.cascade_.model().parameters()[p];
    e.trial_q_[p] = clamp(e.q_[p] + step[kPoseUnknowns + k], parameter.minimum, parameter.maximum);
  }
}

void EstimatorProblem::accept() {
  view = trial_;
  for (std::size_t k = 0; k < e.cascade_.column_count(); ++k) {
    const std::uint16_t p = e.cascade_.parameter_of(k);
    e.q_[p] = e.trial_q_[p];
  }
}

/// Cost of a state; residuals, lengths and chosen alternatives are then its own.
float EstimatorProblem::cost_of(const View& v, const float* q) {
  measure(v, q);
  const float per_scale = 1.0f / scale;
  float sum = prior_cost(v, q);
  for (std::size_t k = 0; k < e.row_count_; ++k)
    if (e.rows_[k].is_kept) sum += evaluate(loss, e.lengths_[k] * per_scale).rho;
  return sum;
}

void EstimatorProblem::minimise(int iterations, float relative_decrease, SolverReport* report) {
  constexpr int kMaxTries = 4;
  float damping = 1e-4f, cost = linearise();
  if (report->iterations == 0) report->initial_cost = cost;
  report->stop_reason = StopReason::iteration_limit;
  bool is_elsewhere = false;  // the residuals are those of a state that was not accepted
  for (int tries = 0; iterations > 0;) {
    e.equations_.solve(damping, e.step_);
    float foreseen = 0;  // decrease, by the equations
    for (std::size_t k = 0; k < e.equations_.count(); ++k) foreseen += 0.5f * e.equations_.g(k) * e.step_[k];
    if (foreseen <= relative_decrease * cost) {
      report->stop_reason = StopReason::converged;
      break;
    }
    move(e.step_);
    --iterations;
    ++report->iterations;
    const float there = cost_of(trial_, e.trial_q_), surprise = magnitude(cost - there - foreseen);
    is_elsewhere = !(there < cost);  // true for NaN
    if (is_elsewhere) {
      damping = max(10 * damping, 1e-3f);
      if (++tries < kMaxTries) continue;
      report->stop_reason = StopReason::no_decrease;
      break;
    }
    accept();
    cost = there;
    damping = max(0.1f * damping, 1e-7f);
    tries = 0;
    // A step that misses what was foreseen by a share leaves about the square of that share to the next one.
    if (surprise * surprise <= relative_decrease * cost * foreseen) {
      report->stop_reason = StopReason::converged;
      break;
    }
    if (iterations > 0) cost = linearise();
  }
  if (is_elsewhere) measure();
  report->final_cost = cost;
  report->undetermined = e.equations_.undetermined_count();
}

std::size_t EstimatorProblem::readmit() {
  update_scale();
  std::size_t kept = 0;
  for (std::size_t k = 0; k < e.row_count_; ++k) {
    e.rows_[k].is_kept = e.lengths_[k] <= e.options_.readmission * scale;
    kept += e.rows_[k].is_kept;
  }
  return kept;
}

/// Over all rows, kept or not, and the priors.
float EstimatorProblem::total_cost(float in_scale) const {
  float sum = prior_cost(view, e.q_);
  for (std::size_t k = 0; k < e.row_count_; ++k) sum += evaluate(Loss::tukey, e.lengths_[k] / in_scale).rho;
  return sum;
}

void EstimatorProblem::exchange(View* other_view, float* other_scale) {
  const View mine = view;
  view = *other_view;
  *other_view = mine;
  const float scale_of_mine = scale;
  scale = *other_scale;
  *other_scale = scale_of_mine;
  for (std::size_t i = 0; i < e.cascade_.parameter_count(); ++i) {
    const float value = e.q_[i];
    e.q_[i] = e.alternative_q_[i];
    e.alternative_q_[i] = value;
  }
}

void EstimatorProblem::try_alternative(SolverReport* report) {
  View other = e.expected_view_;
  float other_scale = 1;
  for (std::size_t i = 0; i < e.cascade_.parameter_count(); ++i) e.alternative_q_[i] = e.expected_q_[i];
  exchange(&other, &other_scale);
  measure();
  e.solve_by_forces(*this, report);
  const float fair = min(scale, other_scale), alternative = total_cost(fair);
  exchange(&other, &other_scale);
  measure();
  if (alternative < e.options_.alternative_margin * total_cost(fair)) {
    exchange(&other, &other_scale);
  } else {
    for (std::size_t k = 0; k < e.row_count_; ++k) e.rows_[k].is_kept = true;
    e.rejected_forces_ = false;
  }
  report->final_cost = linearise();
}

}  // namespace pliant
