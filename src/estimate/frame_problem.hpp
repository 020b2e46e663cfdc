#pragma once
// The least-squares problem of one frame (docs/algorithms.md, sections 5.2 to 5.6): image forces f_i on surface points in the
// generalised force of Eq. 9, the Gauss-Newton matrix of the same sum, priors, and robust weights.
#include "estimate/model_state.hpp"
#include "estimate/motion_model.hpp"
#include "estimate/observation_rows.hpp"
#include "estimate/stretch_rows.hpp"
#include "estimate/surface_points.hpp"
#include "optim/point_row.hpp"
#include "pliant/frame_work.hpp"
#include "pliant/solver.hpp"

namespace pliant {

/// Tuning of the frame problem.
struct FrameProblemTuning {
  /// Largest turn (rad) and relative change of scale in one step. Beyond, the linearisation is wrong anyway. Round value.
  float most_step = 0.3f;
};
inline constexpr FrameProblemTuning kFrameProblemTuning{};

/// Inputs and scratch of a solve besides the state. The estimator owns the objects.
struct SolveInput {
  Cascade& cascade;
  const SurfacePoints& points;
  const ExpectedState& expected;
  const StretchPrior* prior = nullptr;  ///< null without springs
  StretchRows* springs = nullptr;
};

/// Memory of the minimisation.
struct SolveScratch {
  NormalEquations equations;
  float *trial_q = nullptr, *step = nullptr;
  PointRow row;
  FrameWork work;                 ///< of the frame: rows and measured rows
  std::uint32_t spring_rows = 0;  ///< observations that take as much work as the springs

  void lay_out(Arena& arena, std::size_t parameters, std::size_t unknowns);
};

/// Robust least squares over rows of observations, with the parameters' own prior, the temporal prior and that against stretch.
/// `state` is the accepted state. A struct of references: it lives for one solve.
struct FrameProblem {
  const SolveInput& input;
  ObservationRows& rows;
  SolveScratch& scratch;
  ModelState state;  ///< q points to the estimator's parameters
  View trial = {};
  Loss loss = Loss::squares;
  float scale = 1;  ///< of the robust loss, in standard deviations of the observations

  /// Residuals, lengths and chosen alternatives at `state`.
  void measure() { measure(state.view, state.q); }
  /// The same, from predictions that were made at `state`. They are in order of id and include all rows.
  void measure(Span<const Prediction> predictions);
  /// Minimises from `state` with the present loss and scale. Adds to the report. The rows are measured at `state` afterwards;
  /// the equations are those of the last linearisation.
  void minimise(int iterations, float relative_decrease, SolverReport* report);
  /// Cost, residuals and equations at `state`.
  float linearise();
  /// Cost of Tukey's loss over all rows, kept or not, and of the priors.
  float total_cost(float in_scale) const;
  /// The pose columns of B_i (Eq. 10) of one row: those of x, then those of y. \return false behind the camera.
  bool pose_jacobian(std::size_t row, const Projector& projector, float* b) const;

 private:
  std::size_t columns() const { return input.cascade.column_count(); }
  const Parameter& parameter(std::size_t i) const { return input.cascade.model().parameters()[i]; }
  void measure(const View& v, const float* q);
  void announce(std::size_t k) const {
    constexpr std::size_t kAhead = 3;  // rows; as in Estimator::predict
    if (k + kAhead < rows.count()) input.points.announce(rows[k + kAhead].id);
  }
  float try_step(const float* step);
  void accept();
  void add_row(const Projector::Derivatives& d, const Jacobian& jacobian, std::size_t row, float weight);
  float prior_cost(const View& v, const float* q) const;
  void add_priors();
  void pose_offset(const View& v, float (&offset)[kPoseUnknowns]) const;
};

}  // namespace pliant
