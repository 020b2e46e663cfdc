#pragma once
// The least-squares problem of a fit. It minimises, over the pose, the focal length where unknown, and the free parameters,
//
//   sum_i sigma^2 rho(|x_i - Proj(F(q, u_i, v_i))| / (sd_i sigma)) + stiffness sum_k (q_k / sd_k)^2 / 2
//
// This is Eq. 8 with a robust loss rho, and the prior of the parameters, without which 80 points do not determine 100
// parameters (docs/algorithms.md, sections 5.2 and 5.6). Of a landmark matched to the silhouette only the distance across
// the contour counts.
#include "optim/point_row.hpp"
#include "pliant/fit.hpp"
#include "pliant/robust.hpp"

namespace pliant {

/// Memory of a fit: the cascade, the sampled points, the normal equations and scratch arrays. Arrays are indexed by point
/// unless noted.
struct FitWorkspace {
  Cascade cascade;
  NormalEquations equations;
  Vec3* samples = nullptr;  // sampled surface points, one after the other
  Vec2* contour_normal =
      nullptr;  // of a landmark matched to the silhouette, else zero; null without room for such
  float* distance = nullptr;                  // scratch: residual lengths
  float *step = nullptr, *trial_q = nullptr;  // 3 an unknown; a parameter
  PointRow row;                               // scratch of one row

  void lay_out(Arena& arena, const Model& model, std::size_t points);
  Vec3* samples_of(std::size_t point) const { return samples + point * cascade.model().cascade().count; }
};

/// One minimisation: a choice of unknowns and of loss.
struct FitProblem {
  FitWorkspace& work;
  Span<const Correspondence> points;
  const FitOptions& options;
  float* q;              // accepted parameters
  View view{}, trial{};  // accepted and trial view
  Loss loss = Loss::huber;
  float scale = 1;  // robust scale sigma, in standard deviations of a point
  float information = 1;                // of a point, over what its standard deviation alone would give
  const Vec3* held_position = nullptr;  // a point, mm, at q: only the pose is fitted; null: the shape, too
  bool focal_is_known = true;
  float prior_focal = 0;  // px

  std::size_t pose_unknowns() const {
    return static_cast<std::size_t>(focal_is_known ? kPoseUnknowns : kPoseUnknownsWithFocal);
  }
  bool is_shape_free() const { return held_position == nullptr; }
  std::size_t columns() const { return is_shape_free() ? work.cascade.column_count() : 0; }

  Vec3 position(std::size_t point, const float* parameters) const {
    return is_shape_free() ? work.cascade.evaluate(work.samples_of(point), parameters) : held_position[point];
  }
  /// Holds the shape at q. \param at  room for a position of each point.
  void hold_shape(Vec3* at);
  /// The part of a residual that counts: all of it, or that across the contour.
  Vec2 counted(std::size_t point, Vec2 residual) const;
  /// That of projected minus observed position at the accepted state. A point behind the camera is far off.
  Vec2 residual(std::size_t point, const Projector& projector) const;
  LossValue point_loss(std::size_t point, Vec2 residual) const {
    return evaluate(loss, length(counted(point, residual)) / (points[point].sd_px * scale));
  }

  /// The cost at a state.
  float cost(const float* parameters, const View& v) const;
  /// The cost and the normal equations at the accepted state.
  float linearise(NormalEquations& equations);
  float try_step(const float* step);
  void accept();

  SolverReport minimise(int iterations);
  /// Sets the robust scale from the residuals at the accepted state; never below what noise and model error explain.
  void update_scale();

 private:
  const Parameter& parameter(std::size_t column) const {
    return work.cascade.model().parameters()[work.cascade.parameter_of(column)];
  }
  float prior_cost(const float* parameters, const View& v) const;
  void add_point(NormalEquations& equations, std::size_t point, const Projector::Derivatives& d,
                 const Jacobian& jacobian, Vec2 residual, float weight);
  void add_priors(NormalEquations& equations);
  float focal_log(const View& v) const;
};

}  // namespace pliant
