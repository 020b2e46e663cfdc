#pragma once
// The least-squares problem of a fit. Minimises, over pose, focal length when unknown, and the free parameters,
//   sum_i sigma^2 rho(|x_i - Proj(F(q,u_i,v_i))| / (sd_i sigma)) + sum_k (q_k / sd_k)^2 / 2
// i.e. Eq. 8 with a robust loss and the parameters' prior, without which 80 points do not determine 100 parameters. Of a
// point matched to the outline only the distance across the outline counts.
#include "pliant/fit.hpp"
#include "pliant/robust.hpp"

namespace pliant {

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

  std::size_t pose_unknowns() const {
    return static_cast<std::size_t>(focal_is_known ? kPoseUnknowns : kPoseUnknownsWithFocal);
  }
  std::size_t columns() const { return shape_is_free ? fitter.cascade_.column_count() : 0; }
  const Parameter& parameter(std::size_t column) const {
    return fitter.cascade_.model().parameters()[fitter.cascade_.parameter_of(column)];
  }

  /// The part of a residual that counts: all of it, or what is across the outline.
  Vec2 counted(std::size_t point, Vec2 residual) const;
  LossValue point_loss(std::size_t point, Vec2 residual) const {
    return evaluate(loss, length(counted(point, residual)) / (points[point].sd_px * scale));
  }
  float prior_cost(const float* parameters, const View& v) const;
  float cost(const float* parameters, const View& v) const;
  float linearise(NormalEquations& equations);
  float try_step(const float* step);
  void accept();

  SolverReport minimise(int iterations);
  /// Residual lengths in standard deviations give the robust scale at the present state, but never less than the noise
  /// and the model's own misfit.
  void update_scale();

 private:
  void add_point(NormalEquations& equations, std::size_t point, const Projector::Derivatives& d,
                 const Jacobian& jacobian, Vec2 residual, float weight);
  void add_priors(NormalEquations& equations);
  float focal_log(const View& v) const;
};

/// Finds the view from the points themselves: tries analytic starts and a few turned ones with a robust pose-only fit
/// each; the lowest cost wins. `position` holds the points on the model as it is (mm).
void find_start(FitProblem& problem, const Vec3* position, Vec2 centre);

}  // namespace pliant
