#pragma once
// The least-squares problem of one frame: rows of observations with robust weights, the parameters' prior, and a temporal
// prior around what was predicted.
#include "pliant/estimator.hpp"

namespace pliant {

/// Where a point behind the camera is taken to be seen, px: far from all observations.
constexpr Vec2 kBehind{-1e6f, -1e6f};

/// One minimisation over the observations of a frame. Lengths are whitened: in the observation's own deviations, those of
/// a line (rank one) stretched so that their median stands for the same scale as that of a length in the plane.
struct EstimatorProblem {
  EstimatorProblem(Estimator& estimator, Span<Observation> seen, const View& start)
      : e(estimator), observations(seen), view(start) {}

  Estimator& e;
  Span<Observation> observations;
  View view;
  Loss loss = Loss::squares;
  float scale = 1;

  /// Residuals, lengths and chosen alternatives at the accepted state, without derivatives.
  void measure();
  /// The same at the estimator's own state, by its predictions where they are of that state.
  void measure_as_predicted();
  /// Sets the scale of the robust loss to that of the rows kept.
  void update_scale();
  /// Levenberg-Marquardt from the accepted state; adds to the report. It ends where the equations foresee a decrease by
  /// less than the given share of the cost, or where a step brought so nearly what they foresaw that another one would
  /// bring no more. Residuals are those of the accepted state afterwards, the equations those of the step before.
  void minimise(int iterations, float relative_decrease, SolverReport* report);
  /// The same with a loss, in the scale of what residuals are now.
  void settle(Loss new_loss, int iterations, float relative_decrease, SolverReport* report) {
    loss = new_loss;
    update_scale();
    minimise(iterations, relative_decrease, report);
  }
  /// Generalised forces of the rows of rank two in the rigid block, at the accepted state: some are rejected.
  void reject_forces();
  /// Takes back rows that fit what was made of the others. Gives how many there are now.
  std::size_t readmit();
  /// Starts again from the prediction with rejection by forces, and keeps what costs less over all rows: what was found
  /// without, or this. A part of the surface that moves by itself, a jaw that drops, looks to the rigid block as an
  /// occluder does; but the parameters explain it.
  void try_alternative(SolverReport* report);

 private:
  void measure(const View& v, const float* q);
  float cost_of(const View& v, const float* q);
  float linearise();
  void add_row(const Projector::Derivatives& d, const Jacobian& jacobian, std::size_t row, float weight);
  void choose(std::size_t row, Vec2 x);
  float prior_cost(const View& v, const float* q) const;
  void add_priors(const View& v, const float* q) const;
  void pose_offset(const View& v, float (&offset)[kPoseUnknowns]) const;
  void move(const float* step);
  void accept();
  float total_cost(float in_scale) const;
  void exchange(View* other_view, float* other_scale);
  View trial_{};
};

}  // namespace pliant
