#include "estimate/frame_problem.hpp"

namespace pliant {

namespace {

/// Index of the prediction with this id. They are in order of id, and it is there.
std::size_t find(Span<const Prediction> predictions, std::uint16_t id) {
  std::size_t first = 0, end = predictions.count;
  while (end - first > 1) {
    const std::size_t middle = (first + end) / 2;
    (predictions[middle].id <= id ? first : end) = middle;
  }
  PLIANT_ASSERT(predictions[first].id == id);
  return first;
}

}  // namespace

void SolveScratch::lay_out(Arena& arena, std::size_t parameters, std::size_t unknowns) {
  equations.lay_out(arena, unknowns);
  trial_q = arena.take<float>(parameters);
  step = arena.take<float>(unknowns);
  row.lay_out(arena, unknowns);
}

void FrameProblem::measure(const View& v, const float* q) {
  const Projector projector(v, true);
  scratch.work.measured_rows += static_cast<std::uint32_t>(rows.count());
  for (std::size_t k = 0; k < rows.count(); ++k) {
    announce(k);
    Vec2 x = kBehind;
    projector.project(input.cascade.evaluate(input.points.samples(rows[k].id), q), &x);
    rows.measure(k, x);
  }
}

void FrameProblem::measure(Span<const Prediction> predictions) {
  std::size_t at = 0;  // rows are nearly in order of id, too
  for (std::size_t k = 0; k < rows.count(); ++k) {
    const std::uint16_t id = rows[k].id;
    while (at + 1 < predictions.count && predictions[at].id < id) ++at;
    if (predictions[at].id != id) at = find(predictions, id);
    rows.measure(k, predictions[at].x);
  }
}

/// Expected view minus v, in the pose's unknowns.
void FrameProblem::pose_offset(const View& v, float (&offset)[kPoseUnknowns]) const {
  const View& expected = input.expected.mean.view;
  const Vec3 turn = log_rotation(expected.q * conjugate(v.q));
  const float out[kPoseUnknowns] = {
      turn.x, turn.y, turn.z, (expected.s - v.s) / v.s, expected.tau.x - v.tau.x, expected.tau.y - v.tau.y};
  for (int k = 0; k < kPoseUnknowns; ++k) offset[k] = out[k];
}

float FrameProblem::prior_cost(const View& v, const float* q) const {
  const ExpectedState& expected = input.expected;
  float offset[kPoseUnknowns], cost = 0;
  pose_offset(v, offset);
  for (int k = 0; k < kPoseUnknowns; ++k) cost += 0.5f * offset[k] * offset[k] / expected.pose_variance[k];
  for (std::size_t k = 0; k < columns(); ++k) {
    const std::uint16_t p = input.cascade.parameter_of(k);
    const float z = q[p] / parameter(p).sd, t = (q[p] - expected.mean.q[p]) / expected.parameter_sd[p];
    cost += 0.5f * z * z + evaluate(Loss::huber, magnitude(t)).rho;
  }
  if (input.springs == nullptr) return cost;
  scratch.work.measured_rows += scratch.spring_rows;
  return cost + input.prior->apply(*input.springs, input.cascade, q, nullptr);
}

void FrameProblem::add_priors() {
  const ExpectedState& expected = input.expected;
  NormalEquations& equations = scratch.equations;
  float offset[kPoseUnknowns];
  pose_offset(state.view, offset);
  for (std::size_t k = 0; k < kPoseUnknowns; ++k)
    equations.add_prior(k, offset[k], 1.0f / expected.pose_variance[k]);
  constexpr float kMostStep = kFrameProblemTuning.most_step;
  for (std::size_t k = 0; k <= kLogScale; ++k) equations.set_limits(k, -kMostStep, kMostStep);
  for (std::size_t k = 0; k < columns(); ++k) {
    const std::uint16_t i = input.cascade.parameter_of(k);
    const float q = state.q[i], sd = expected.parameter_sd[i];
    add_prior(parameter(i), q, 1, kPoseUnknowns + k, equations);
    const float change = expected.mean.q[i] - q, weight = evaluate(Loss::huber, magnitude(change / sd)).weight;
    equations.add_prior(kPoseUnknowns + k, change, weight / (sd * sd));
  }
  if (input.springs == nullptr) return;
  scratch.work.rows += scratch.spring_rows;
  input.prior->apply(*input.springs, input.cascade, state.q, &equations);
}

void FrameProblem::add_row(const Projector::Derivatives& d, const Jacobian& jacobian, std::size_t row,
                           float weight) {
  const Sym2 w = rows.information(row);
  scratch.row.add_to(scratch.equations, {d.pose, kPoseUnknowns}, d, jacobian, rows.residual(row),
                     {weight * w.xx, weight * w.xy, weight * w.yy});
}

float FrameProblem::linearise() {
  scratch.equations.reset(kPoseUnknowns + columns());
  scratch.work.rows += static_cast<std::uint32_t>(rows.count());
  const Projector projector(state.view, true);
  const float per_scale = 1.0f / scale, per_square = per_scale * per_scale;
  for (std::size_t k = 0; k < rows.count(); ++k) {
    announce(k);
    Jacobian jacobian;
    const Vec3 p = input.cascade.evaluate(input.points.samples(rows[k].id), state.q, &jacobian);
    Vec2 x = kBehind;
    Projector::Derivatives d;
    const bool in_front = projector.project(p, &x, &d);
    rows.measure(k, x);
    if (!rows[k].is_kept) continue;
    const float weight = evaluate(loss, rows.length(k) * per_scale).weight;
    if (in_front && weight > 0) add_row(d, jacobian, k, weight * per_square);
  }
  add_priors();
  return prior_cost(state.view, state.q) + rows.cost(loss, scale, true);
}

float FrameProblem::try_step(const float* step) {
  trial = moved(state.view, step, kPoseUnknowns);
  for (std::size_t k = 0; k < columns(); ++k) {
    const std::uint16_t i = input.cascade.parameter_of(k);
    scratch.trial_q[i] = stepped(parameter(i), state.q[i], step[kPoseUnknowns + k]);
  }
  measure(trial, scratch.trial_q);
  return prior_cost(trial, scratch.trial_q) + rows.cost(loss, scale, true);
}

void FrameProblem::accept() {
  state.view = trial;
  for (std::size_t k = 0; k < columns(); ++k) {
    const std::uint16_t i = input.cascade.parameter_of(k);
    state.q[i] = scratch.trial_q[i];
  }
}

void FrameProblem::minimise(int iterations, float relative_decrease, SolverReport* report) {
  copy(state.q, input.cascade.parameter_count(), scratch.trial_q);  // a trial changes those that are free
  const LeastSquaresProblem problem{
      this, [](void* p, NormalEquations&) { return static_cast<FrameProblem*>(p)->linearise(); },
      [](void* p, const float* step) { return static_cast<FrameProblem*>(p)->try_step(step); },
      [](void* p) { static_cast<FrameProblem*>(p)->accept(); }};
  SolverOptions options;
  options.max_accepted = options.max_steps = iterations;
  options.measured_decrease = 0;
  options.predicted_decrease = relative_decrease;
  const SolverReport now = pliant::minimise(problem, options, scratch.equations, scratch.step);
  if (now.ends_with_refused_step) measure();
  const SolverReport before = *report;
  *report = now;
  report->iterations += before.iterations;
  if (before.iterations > 0) report->initial_cost = before.initial_cost;
}

float FrameProblem::total_cost(float in_scale) const {
  return prior_cost(state.view, state.q) + rows.cost(Loss::tukey, in_scale, false);
}

bool FrameProblem::pose_jacobian(std::size_t row, const Projector& projector, float* b) const {
  Vec2 x;
  Projector::Derivatives d{};
  if (!projector.project(input.cascade.evaluate(input.points.samples(rows[row].id), state.q), &x, &d))
    return false;
  for (int k = 0; k < kPoseUnknowns; ++k) {
    b[k] = d.pose[k].x;
    b[kPoseUnknowns + k] = d.pose[k].y;
  }
  return true;
}

}  // namespace pliant
