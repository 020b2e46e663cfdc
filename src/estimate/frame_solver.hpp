#pragma once
// Observations of a frame -> pose and parameters, with rejection of outliers and an alternative hypothesis
// (docs/algorithms.md, section 6.5).
#include "estimate/force_rejection.hpp"
#include "estimate/frame_problem.hpp"
#include "estimate/track_monitor.hpp"
#include "pliant/estimator_options.hpp"

namespace pliant {

/// Of a frame that may take as long as it needs; in the unit of WorkCosts.
inline constexpr float kNoWorkLimit = 1e30f;

/// Tuning of the solve. The experiments are those of docs/experiments.md, section Tuning.
struct FrameSolverTuning {
  /// Equations that a solve needs at least: those of the pose and four more.
  std::size_t least_equations = kPoseUnknowns + 4;
  /// Fraction of the cost. A minimisation stops at a smaller decrease. It leaves a cost within 0.002 % of the optimum
  /// (known optimum).
  float relative_decrease = 1e-3f;
  /// The same for Huber's loss, after which Tukey's loss goes on. It only has to come near. Round value.
  float relative_decrease_huber = 0.02f;
  /// Steps after rejected rows were taken back, count. Round value, not tuned.
  int readmission_iterations = 3;
  /// Scales of the residuals within which a rejected row is taken back. Chosen on the
  /// occlusion table.
  float readmission_scales = 3.5f;
  /// Robust scale, in the noise that the cues usually have, above which a result is doubtful.
  /// Chosen on the occlusion table and by watching the recorded face.
  float doubt_scale = 1.2f;
  /// Fraction of outliers above which a result is doubtful. Chosen likewise.
  float doubt_fraction = 0.15f;
  /// The alternative replaces the result if its cost is below this fraction of the result's. Chosen
  /// likewise.
  float alternative_margin = 0.8f;
  /// Fraction of outliers, at the state after a first pass, above which Huber's loss is used again and the frame
  /// needs another round. Chosen on the rendered film with 500 points.
  float outliers_after_first_pass = 0.03f;
  /// Factorisations of a step, count: limits of parameters that it meets take more than one. 2 to 3 on the recorded face.
  float factorisations_a_step = 3;
  /// Steps without which the alternative hypothesis is not tried, count. Round value, not tuned.
  int least_of_alternative = 4;
  /// Scaled Cholesky pivot below which the observations do not determine the pose. The value of docs/algorithms.md, section 5.5.
  float least_pivot = 1e-4f;
};
inline constexpr FrameSolverTuning kFrameSolverTuning{};

/// Upper bound of the Gauss-Newton steps of a frame, count, for a first pass and `solves` calls of `solve`, with at most
/// `iterations` steps of each minimisation. `pliant plan` prints it.
constexpr int most_solve_steps(int iterations, int solves) {
  // The first pass and the first solve minimise with Huber's loss, then with Tukey's. The alternative does the same, and a
  // third time after rejected rows were taken back. Every later solve minimises with Tukey's loss.
  const int minimisations = 2 + 2 + 2 + (solves - 1);
  return minimisations * iterations + kFrameSolverTuning.readmission_iterations;
}

/// Capacities of a FrameSolver.
struct FrameSolverLimits {
  std::size_t points = 0, parameters = 0;
  std::size_t unknowns = 0;  ///< pose and free parameters
  std::size_t rejection_sample = 0;
  const ForceRejection* rejection = nullptr;
  Span<unsigned char> solve_memory;  ///< as EstimatorLimits::solve_memory
};

/// How the solves of a track are made.
struct SolvePolicy {
  int iterations = 0;  ///< trial steps of each minimisation, at most
  Rejection rejection = Rejection::none;
  RowPolicy rows;
};

/// The solves of a frame. `state` is the estimator's: a solve moves it to fit the observations.
class FrameSolver {
 public:
  void lay_out(Arena& arena, const FrameSolverLimits& limits);
  void start(const SolvePolicy& policy);
  /// Starts a frame: no solve yet.
  void begin();
  /// Forgets that a point was rejected; to be called for a new point.
  void forget(std::uint16_t id) { was_rejected_[id] = 0; }

  /// Fits a few points before the first `solve` of a frame, by weights alone.
  /// \return false if the result is doubtful or the points do not determine the pose; then `state` is unchanged.
  bool solve_first_pass(const SolveInput& input, Span<Observation> observations, ModelState* state);
  /// True if too many rows did not fit the state after a first pass.
  bool needs_another_round() const { return needs_another_round_; }
  /// Fits all points and marks outliers as rejected. With too few observations `state` is unchanged.
  /// \param predictions  of all points at `state`, or none.
  SolverReport solve(const SolveInput& input, Span<Observation> observations,
                     Span<const Prediction> predictions, ModelState* state);
  /// Of the solves of this frame.
  const SolveResult& result() const { return result_; }

  /// Ends solves of this frame early, once they have taken so much: the state is then less exact. \param most  in the unit of
  /// `costs`.
  void limit_work(const WorkCosts& costs, float most) {
    costs_ = costs;
    most_work_ = most;
  }
  /// Rows, measured rows and factorisations of this frame.
  FrameWork work() const;

  /// To be called after a good frame: computes variances and follows the noise of the cues.
  void conclude_frame();
  /// Variance of each unknown after the last good frame: pose, then columns.
  const float* variance() const { return variance_; }
  std::size_t unknown_capacity() const { return scratch_.equations.capacity(); }
  float cue_scale(Cue cue) const { return rows_.cue_scale(cue); }

 private:
  bool has_enough() const { return rows_.equations() >= kFrameSolverTuning.least_equations; }
  int steps_left() const;
  void gather(const SolveInput& input, Span<Observation> observations);
  void settle(FrameProblem& problem, Loss loss, SolverReport* report);
  void settle_by_weights(FrameProblem& problem, SolverReport* report);
  void solve_by_forces(FrameProblem& problem, SolverReport* report);
  void solve_robustly(FrameProblem& problem, SolverReport* report);
  void try_alternative(FrameProblem& problem, SolverReport* report);
  void exchange(FrameProblem& problem, View* view, float* scale) const;
  void keep_as_before(FrameProblem& problem);
  bool is_doubtful(const FrameProblem& problem) const;
  bool pose_is_observed(const ExpectedState& expected);
  void conclude(const FrameProblem& problem);

  SolvePolicy policy_;
  ObservationRows rows_;
  SolveScratch scratch_;
  float *alternative_q_ = nullptr, *variance_ = nullptr;
  std::uint8_t* was_rejected_ = nullptr;  // by id, in the last solve
  const ForceRejection* rejection_ = nullptr;
  RowForces* forces_ = nullptr;
  std::size_t parameters_ = 0;
  SolveResult result_;
  WorkCosts costs_;
  float most_work_ = kNoWorkLimit;           // of a frame
  int solves_ = 0;                           // of this frame
  std::uint32_t factorisations_before_ = 0;  // the frame
  bool had_first_pass_ = false, needs_another_round_ = false;
  bool rejected_forces_ = false;  // in the frame's first solve
};

}  // namespace pliant
