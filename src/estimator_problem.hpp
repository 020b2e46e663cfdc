#pragma once
// The least-squares problem of one frame: observations with robust weights, the parameters' prior, and a temporal prior
// around what was expected.
#include "pliant/estimator.hpp"

namespace pliant {

inline float mahalanobis(Sym2 w, Vec2 r) {
  return square_root(w.xx * r.x * r.x + 2 * w.xy * r.x * r.y + w.yy * r.y * r.y);
}

/// One minimisation over the observations of a frame.
struct EstimatorProblem {
  Estimator& e;
  Span<Observation> observations;
  std::size_t usable;
  View view{}, trial{};
  Loss loss = Loss::huber;
  float scale = 1;

  float prior_cost(const float* q) const {
    float cost = 0;
    for (std::size_t k = 0; k < e.cascade_.column_count(); ++k) {
      const std::uint16_t p = e.cascade_.parameter_of(k);
      const float z = q[p] / e.cascade_.model().parameters()[p].sd, t = (q[p] - e.expected_q_[p]) / e.sd_[p];
      cost += 0.5f * (e.options_.prior_strength * z * z + t * t);
    }
    return cost;
  }

  float cost(const View& v, const float* q) const {
    const Projector projector(v, true);
    float sum = 0;
    for (std::size_t k = 0; k < usable; ++k) {
      const Observation& o = observations[e.usable_[k]];
      Vec2 x;
      if (!projector.project(e.cascade_.evaluate(e.baked_point(o.id), q), &x)) return 1e30f;
      sum += evaluate(loss, mahalanobis(e.information_[k], o.x - x) / scale).rho;
    }
    return sum + prior_cost(q);
  }

  float linearise(NormalEquations& equations) {
    equations.reset(kPoseUnknowns + e.cascade_.column_count());
    const Projector projector(view, true);
    const float share = 1.0f / (scale * scale);
    float sum = 0;
    for (std::size_t k = 0; k < usable; ++k) {
      const Observation& o = observations[e.usable_[k]];
      Jacobian jacobian;
      const Vec3 p = e.cascade_.evaluate(e.baked_point(o.id), e.q_, &jacobian);
      Vec2 x;
      Projector::Derivatives d;
      if (!projector.project(p, &x, &d)) continue;
      const Sym2 w = e.information_[k];
      const LossValue value = evaluate(loss, mahalanobis(w, o.x - x) / scale);
      sum += value.rho;
      if (value.weight <= 0) continue;
      std::size_t n = 0;
      for (; n < kPoseUnknowns; ++n) {
        e.unknown_[n] = static_cast<std::uint16_t>(n);
        e.column_[n] = d.pose[n];
      }
      for (std::size_t c = 0; c < jacobian.count; ++c, ++n) {
        e.unknown_[n] = static_cast<std::uint16_t>(kPoseUnknowns + jacobian.list[c]);
        e.column_[n] = d.along(jacobian.column[jacobian.list[c]]);
      }
      const float f = value.weight * share;
      equations.add(e.unknown_, e.column_, n, o.x - x, {f * w.xx, f * w.xy, f * w.yy});
    }
    add_priors(equations);
    return sum + prior_cost(e.q_);
  }

  void add_priors(NormalEquations& equations) const {
    for (std::size_t k = 0; k < e.cascade_.column_count(); ++k) {
      const std::uint16_t p = e.cascade_.parameter_of(k);
      const Parameter& parameter = e.cascade_.model().parameters()[p];
      const std::size_t unknown = kPoseUnknowns + k;
      equations.add_prior(unknown, -e.q_[p], e.options_.prior_strength / (parameter.sd * parameter.sd));
      equations.add_prior(unknown, e.expected_q_[p] - e.q_[p], 1.0f / (e.sd_[p] * e.sd_[p]));
      equations.set_limits(unknown, min(parameter.minimum - e.q_[p], 0), max(parameter.maximum - e.q_[p], 0));
    }
    for (std::size_t k = 0; k < 3; ++k) equations.set_limits(k, -0.3f, 0.3f);
    equations.set_limits(kLogScale, -0.3f, 0.3f);
  }

  float try_step(const float* step) {
    trial = moved(view, step, kPoseUnknowns);
    for (std::size_t i = 0; i < e.cascade_.parameter_count(); ++i) e.trial_q_[i] = e.q_[i];
    for (std::size_t k = 0; k < e.cascade_.column_count(); ++k) {
      const std::uint16_t p = e.cascade_.parameter_of(k);
      const Parameter& parameter = e.cascade_.model().parameters()[p];
      e.trial_q_[p] = clamp(e.q_[p] + step[kPoseUnknowns + k], parameter.minimum, parameter.maximum);
    }
    return cost(trial, e.trial_q_);
  }

  void accept() {
    view = trial;
    for (std::size_t i = 0; i < e.cascade_.parameter_count(); ++i) e.q_[i] = e.trial_q_[i];
  }

  SolverReport minimise(int iterations) {
    const LeastSquaresProblem problem{
        this, [](void* p, NormalEquations& n) { return static_cast<EstimatorProblem*>(p)->linearise(n); },
        [](void* p, const float* s) { return static_cast<EstimatorProblem*>(p)->try_step(s); },
        [](void* p) { static_cast<EstimatorProblem*>(p)->accept(); }};
    SolverOptions solver;
    solver.max_iterations = iterations;
    solver.relative_decrease = e.options_.relative_decrease;
    return pliant::minimise(problem, solver, e.equations_, e.step_);
  }

  /// Length of the k-th usable observation's residual, in its own deviations and in pixels.
  float residual(std::size_t k, float* px) const {
    const Observation& o = observations[e.usable_[k]];
    Vec2 x = o.x + Vec2{1e6f, 0};
    Projector(view, true).project(e.cascade_.evaluate(e.baked_point(o.id), e.q_), &x);
    *px = length(o.x - x);
    return mahalanobis(e.information_[k], o.x - x);
  }

  void update_scale() {
    float px;
    for (std::size_t k = 0; k < usable; ++k) e.lengths_[k] = residual(k, &px);
    scale = clamp(robust_scale(e.lengths_, usable), 1, 8);
  }
};

}  // namespace pliant
