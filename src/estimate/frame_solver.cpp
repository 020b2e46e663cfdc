#include "estimate/frame_solver.hpp"

#include "base/integers.hpp"

namespace pliant {

namespace {
constexpr const FrameSolverTuning& kTuning = kFrameSolverTuning;
}

void FrameSolver::lay_out(Arena& arena, const FrameSolverLimits& limits) {
  parameters_ = limits.parameters;
  arena.count_as(Purpose::solver);
  Arena lent(limits.solve_memory.data, limits.solve_memory.count);
  scratch_.lay_out(limits.solve_memory.empty() ? arena : lent, limits.parameters, limits.unknowns);
  variance_ = arena.take<float>(limits.unknowns);
  alternative_q_ = arena.take<float>(limits.parameters);
  arena.count_as(Purpose::points);
  rows_.lay_out(arena, limits.points);
  was_rejected_ = arena.take<std::uint8_t>(limits.points);
  const std::size_t sample = smaller(limits.rejection_sample, limits.points);
  rejection_ = sample > 0 ? limits.rejection : nullptr;
  arena.count_as(Purpose::rejection);
  forces_ = rejection_ != nullptr ? rejection_->lay_out(arena, sample) : nullptr;
}

void FrameSolver::start(const SolvePolicy& policy) {
  policy_ = policy;
  most_work_ = kNoWorkLimit;
  rows_.start(policy.rows);
  for (std::size_t k = 0; k < unknown_capacity(); ++k) variance_[k] = 0;
  begin();
}

void FrameSolver::begin() {
  rows_.clear();
  result_ = {};
  scratch_.work = {};
  factorisations_before_ = scratch_.equations.factorisation_count();
  solves_ = 0;
  had_first_pass_ = needs_another_round_ = rejected_forces_ = false;
}

FrameWork FrameSolver::work() const {
  FrameWork work = scratch_.work;
  work.factorisations = scratch_.equations.factorisation_count() - factorisations_before_;
  return work;
}

/// Steps of a minimisation for which there is work left, beside its last pass.
int FrameSolver::steps_left() const {
  const float rows = static_cast<float>(rows_.count() + scratch_.spring_rows), pass = rows * costs_.row;
  const float step = pass + rows * costs_.measured_row + kTuning.factorisations_a_step * costs_.factorisation;
  const float steps = (most_work_ - costs_.of_solves(work()) - pass) / step;
  return static_cast<int>(clamp(steps, 0, static_cast<float>(policy_.iterations)));
}

void FrameSolver::gather(const SolveInput& input, Span<Observation> observations) {
  rows_.gather(observations, input.points, input.expected.mean.view.s);
  scratch_.spring_rows =
      input.springs == nullptr ? 0 : static_cast<std::uint32_t>(input.springs->work_rows());
  result_.searched = rows_.searched();
  result_.patches_searched = rows_.patches_searched();
}

bool FrameSolver::solve_first_pass(const SolveInput& input, Span<Observation> observations,
                                   ModelState* state) {
  had_first_pass_ = needs_another_round_ = false;
  gather(input, observations);
  if (!has_enough() || 2 * rows_.count() < rows_.searched()) return false;
  copy(state->q, parameters_, alternative_q_);
  FrameProblem problem{input, rows_, scratch_, *state};
  SolverReport report;
  problem.measure();
  settle_by_weights(problem, &report);
  result_.iterations = static_cast<std::uint16_t>(result_.iterations + report.iterations);
  had_first_pass_ = !is_doubtful(problem) && pose_is_observed(input.expected);
  if (had_first_pass_)
    state->view = problem.state.view;
  else
    copy(alternative_q_, parameters_, state->q);
  return had_first_pass_;
}

SolverReport FrameSolver::solve(const SolveInput& input, Span<Observation> observations,
                                Span<const Prediction> predictions, ModelState* state) {
  SolverReport report;
  const std::uint16_t iterations = result_.iterations;
  result_ = {};
  result_.iterations = iterations;
  gather(input, observations);
  result_.rows = static_cast<std::uint16_t>(rows_.count());
  if (!has_enough()) {
    rows_.clear();
    return report;
  }
  FrameProblem problem{input, rows_, scratch_, *state};
  if (predictions.empty())
    problem.measure();
  else
    problem.measure(predictions);
  if (policy_.rejection == Rejection::none)
    problem.minimise(steps_left(), kTuning.relative_decrease, &report);
  else
    solve_robustly(problem, &report);
  state->view = problem.state.view;
  result_.iterations = static_cast<std::uint16_t>(result_.iterations + report.iterations);
  conclude(problem);
  return report;
}

/// Minimises with a loss in the scale of the residuals as they are.
void FrameSolver::settle(FrameProblem& problem, Loss loss, SolverReport* report) {
  problem.loss = loss;
  problem.scale = rows_.scale();
  const int steps = steps_left();
  if (steps == 0 && loss == Loss::huber) return;  // Tukey's is the last and leaves the equations
  problem.minimise(steps, loss == Loss::huber ? kTuning.relative_decrease_huber : kTuning.relative_decrease,
                   report);
}

/// Tukey's loss has local minima; Huber's loss is convex in the residuals and finds the right one. After a first pass the
/// state is near enough for Tukey's loss, unless a part moved that the first-pass points do not cover, such as the jaw.
void FrameSolver::settle_by_weights(FrameProblem& problem, SolverReport* report) {
  if (had_first_pass_) {
    problem.scale = rows_.scale();
    needs_another_round_ = rows_.outlier_fraction(problem.scale) > kTuning.outliers_after_first_pass;
  }
  if (!had_first_pass_ || needs_another_round_) settle(problem, Loss::huber, report);
  settle(problem, Loss::tukey, report);
}

void FrameSolver::solve_robustly(FrameProblem& problem, SolverReport* report) {
  const Rejection rejection = policy_.rejection;
  if (solves_++ > 0) {
    if (rejected_forces_) keep_as_before(problem);
    settle(problem, Loss::tukey, report);
  } else if (rejection == Rejection::forces || rejection == Rejection::forces_readmitted) {
    solve_by_forces(problem, report);
  } else {
    settle_by_weights(problem, report);
    if (rejection == Rejection::on_doubt && is_doubtful(problem) &&
        (steps_left() >= kTuning.least_of_alternative || steps_left() == policy_.iterations))
      try_alternative(problem, report);
  }
}

void FrameSolver::solve_by_forces(FrameProblem& problem, SolverReport* report) {
  rejected_forces_ = true;
  if (forces_ != nullptr) {
    rejection_->reject(*forces_, problem);
    scratch_.work.forces += static_cast<std::uint32_t>(rows_.count());
  }
  settle(problem, Loss::huber, report);
  settle(problem, Loss::tukey, report);
  if (policy_.rejection == Rejection::forces) return;
  problem.scale = rows_.scale();
  rows_.keep_within(kTuning.readmission_scales * problem.scale);
  problem.minimise(smaller(steps_left(), kTuning.readmission_iterations), kTuning.relative_decrease, report);
}

/// True if the residuals are well above the usual noise of the cues, or many rows have no weight. Coherent motion of an
/// occluder causes both.
bool FrameSolver::is_doubtful(const FrameProblem& problem) const {
  return problem.scale > kTuning.doubt_scale ||
         rows_.outlier_fraction(problem.scale) > kTuning.doubt_fraction;
}

/// In a later round, rows that the round before rejected must fit before they take part.
void FrameSolver::keep_as_before(FrameProblem& problem) {
  for (std::size_t k = 0; k < rows_.count(); ++k) rows_[k].is_kept = was_rejected_[rows_[k].id] == 0;
  problem.scale = rows_.scale();
  rows_.keep_within(kTuning.readmission_scales * problem.scale);
}

/// Exchanges the problem's state and scale with another hypothesis, whose parameters are in alternative_q_.
void FrameSolver::exchange(FrameProblem& problem, View* view, float* scale) const {
  const View mine = problem.state.view;
  problem.state.view = *view;
  *view = mine;
  const float scale_of_mine = problem.scale;
  problem.scale = *scale;
  *scale = scale_of_mine;
  for (std::size_t i = 0; i < parameters_; ++i) {
    const float value = problem.state.q[i];
    problem.state.q[i] = alternative_q_[i];
    alternative_q_[i] = value;
  }
}

/// Solves again from the expected state with rejection by forces, and keeps the result with the lower cost over all rows. Both
/// results are needed: rejection by the rigid block takes a part with its own motion for an occluder, although the parameters
/// can explain that motion.
void FrameSolver::try_alternative(FrameProblem& problem, SolverReport* report) {
  const ModelState& expected = problem.input.expected.mean;
  View other = expected.view;
  float other_scale = 1;
  copy(expected.q, parameters_, alternative_q_);
  exchange(problem, &other, &other_scale);
  problem.measure();
  solve_by_forces(problem, report);
  const float common = min(problem.scale, other_scale), alternative = problem.total_cost(common);
  exchange(problem, &other, &other_scale);
  problem.measure();
  if (alternative < kTuning.alternative_margin * problem.total_cost(common)) {
    exchange(problem, &other, &other_scale);
  } else {
    for (std::size_t k = 0; k < rows_.count(); ++k) rows_[k].is_kept = true;
    rejected_forces_ = false;
  }
  report->final_cost = problem.linearise();
}

/// Counts the inliers and marks the rejected observations.
void FrameSolver::conclude(const FrameProblem& problem) {
  float square_sum = 0, score_sum = 0;
  std::uint16_t inliers = 0, scored = 0;
  result_.patch_inliers = 0;
  for (std::size_t k = 0; k < rows_.count(); ++k) {
    const ObservationRow& row = rows_[k];
    const bool fits =
        row.is_kept && (problem.loss == Loss::squares || is_inlier(rows_.length(k), problem.scale));
    was_rejected_[row.id] = fits ? 0 : 1;
    Observation* const alternatives = rows_.observations_of(k);
    for (std::uint8_t i = 0; i < row.count; ++i)
      if (alternatives[i].reason == Reason::found && !(fits && i == row.chosen))
        alternatives[i].reason = Reason::rejected;
    alternatives[row.chosen].residual = rows_.residual(k);
    if (!fits) continue;
    ++inliers;
    square_sum += rows_.squared_px(k);
    if (row.cue != Cue::patch) continue;
    ++result_.patch_inliers;
    score_sum += alternatives[row.chosen].score;
    scored = static_cast<std::uint16_t>(scored + (alternatives[row.chosen].score != 0));
  }
  result_.inliers = inliers;
  result_.rms_px = inliers > 0 ? square_root(square_sum / static_cast<float>(inliers)) : 0.0f;
  result_.score = scored > 0 ? score_sum / static_cast<float>(scored) : 0.0f;
  result_.pose_is_observed = pose_is_observed(problem.input.expected);
}

/// Tests the pivots of the scaled Cholesky factor of the pose block, without the temporal prior (docs/algorithms.md,
/// section 5.5).
bool FrameSolver::pose_is_observed(const ExpectedState& expected) {
  NormalEquations& equations = scratch_.equations;
  float l[kPoseUnknowns][kPoseUnknowns];
  for (std::size_t j = 0; j < kPoseUnknowns; ++j) {
    const float diagonal = equations.h(j, j) - 1.0f / expected.pose_variance[j];
    float pivot = diagonal;
    for (std::size_t k = 0; k < j; ++k) {
      l[j][k] = equations.h(j, k);
      for (std::size_t m = 0; m < k; ++m) l[j][k] -= l[j][m] * l[k][m];
      l[j][k] /= l[k][k];
      pivot -= l[j][k] * l[j][k];
    }
    if (!(diagonal > 0) || !(pivot > kTuning.least_pivot * diagonal)) return false;
    l[j][j] = square_root(pivot);
  }
  return true;
}

void FrameSolver::conclude_frame() {
  scratch_.equations.variances(variance_);
  rows_.update_cue_scales();
}

}  // namespace pliant
