#pragma once
/// \file solver.hpp
/// Levenberg-Marquardt minimisation of a nonlinear least-squares problem (docs/algorithms.md, section 5.2).
#include <cstddef>
#include <cstdint>

#include "pliant/normal_equations.hpp"

namespace pliant {

/// A nonlinear least-squares problem. The caller holds its state twice: the accepted state and a trial state.
struct LeastSquaresProblem {
  void* context;  ///< passed to the functions
  /// Writes the normal equations of the accepted state, with limits, into `equations`. The callee resets them.
  /// \return the cost: half the weighted sum of squares, with priors and robust loss.
  float (*linearise)(void* context, NormalEquations& equations);
  /// Sets trial = accepted moved by `step`. \return the cost of the trial state.
  float (*try_step)(void* context, const float* step);
  /// Sets accepted = trial.
  void (*accept)(void* context);
};

/// Stopping criteria of a minimisation. The first one that holds ends it.
struct SolverOptions {
  int max_accepted = 8;  ///< accepted steps, count
  /// Trial steps, accepted or refused, count. Each costs a factorisation and a `try_step`.
  int max_steps = 256;
  int max_refused = 4;  ///< refused steps in a row, count; the damping rises after each
  /// Fraction of the cost: stop after an accepted step that lowered the cost by no more. 0: never.
  float measured_decrease = 1e-5f;
  /// Fraction of the cost: stop before a step for which the equations predict no larger decrease, and after
  /// an accepted step whose prediction error shows that the next step would gain no more. It saves the last
  /// step of `measured_decrease`. 0: never.
  float predicted_decrease = 0;
};

/// Why a minimisation ended.
enum class StopReason : std::uint8_t {
  converged,        ///< the decrease of the cost is below a limit of the options
  iteration_limit,  ///< max_accepted or max_steps; EulerOptions::steps
  no_decrease,      ///< max_refused: no step lowers the cost
  diverged,         ///< the cost is no longer a finite number: the published dynamics (euler.hpp) only
};

/// Result of a minimisation.
struct SolverReport {
  int iterations = 0;                                    ///< trial steps
  StopReason stop_reason = StopReason::iteration_limit;  ///< why it ended
  float initial_cost = 0, final_cost = 0;                ///< before and after
  std::size_t undetermined = 0;                          ///< unknowns that the observations do not determine
  bool ends_with_refused_step = false;  ///< the last `try_step` was of a state that was not accepted
};

/// Levenberg-Marquardt: a step is accepted when it lowers the cost. Damping falls after an accepted step and
/// rises after a refused one.
/// Afterwards `equations` are those of the last linearisation: of the state before the last accepted step, unless
/// the loop stopped before or after a refused step.
/// \param step_scratch  a float an unknown.
/// Cost: at most max_steps factorisations and trial costs, and max_accepted linearisations.
SolverReport minimise(const LeastSquaresProblem& problem, const SolverOptions& options,
                      NormalEquations& equations, float* step_scratch);

}  // namespace pliant
