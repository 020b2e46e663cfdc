#pragma once
/// \file person_refinement.hpp
/// The identity of the tracked person, estimated while the head turns (docs/algorithms.md, section 7.20).
#include "pliant/arena.hpp"
#include "pliant/model.hpp"
#include "pliant/tracker_limits.hpp"

namespace pliant {

struct TrackerOptions;
struct TrackerParts;
struct PersonState;

/// Tuning of when the estimate is made and used.
struct PersonRefinementTuning {
  /// Frames from one that is taken into the estimate to the next, at least; the same in a view that has
  /// enough. A frame costs a fifth of its time more. Four is as good as two.
  std::uint32_t interval_frames = 4, interval_when_known = 16;
  /// Observations that a frame takes, fewer than this and what its budget has room for: of more each second, third,
  /// ... One costs 27,000 instructions with the built-in face. 96 had as small errors with profile M, and with profile L 4.1
  /// instead of 3.3 degrees at 95 %.
  std::size_t most_observations = 192;
  /// Observations for which a frame must have room to be taken, count. Round value, not tuned.
  std::size_t least_observations = 64;
  /// Steps that go all of the way to the estimate, count, and the fraction of the way of the later ones, of which there is at most
  /// one in so many frames. What is seen moves by less than the noise of a frame. Rendered heads that turn
  /// (docs/experiments.md) had 3.65 degrees at 95 % with half of the way always, 3.29 with all of it, found by
  /// detection. Later steps change little, and with whole ones the recorded face trembles more.
  std::uint32_t whole_steps = 4;
  float later_rate = 0.25f;
  std::uint32_t step_frames = 8;
  /// Standard deviation of the start's identity, in those of the population: that of the prior. Not tuned.
  float start_sd = 1;
  /// A step below this is not worth its time: standard deviations of an identity parameter; rad. Round
  /// values, not tuned.
  float least_step_sd = 0.05f, least_turn = 0.002f;
  /// Longest step in (u,v), each way, by which a template's point goes back to where it was seen, and steps of Newton's
  /// method, count. Round values, not tuned.
  float most_slide = 0.02f;
  int slides = 2;
  /// Templates of which a frame prepares the step, count: 2.6 million instructions. Round value, not tuned.
  std::size_t prepared_templates = 64;
  /// Work for each record of the cascade, instructions as WorkCosts: of an observation that is taken, of a template
  /// that is prepared, and, in the step itself, of a point and a landmark. Counted with profile M.
  float observation_work = 390, prepared_work = 590, point_work = 235, landmark_work = 340;
};
inline constexpr PersonRefinementTuning kPersonRefinementTuning{};

/// Work of the step that changes the person, at most; instructions, as WorkCosts.
float person_step_work(const Model& model, const TrackerLimits& limits);

/// The calls of a tracker. It makes them through TrackerLimits::person only, so that a program whose limits
/// name none does not link what is behind it.
struct PersonRefinement {
  /// Takes the state from the arena. \return null if the arena measures, or the model has no identity.
  PersonState* (*lay_out)(Arena& arena, const Model& model, const TrackerLimits& limits);
  /// Bytes that `conclude` takes of the tracker's scratch.
  std::size_t (*scratch_bytes)(const Model& model, const TrackerLimits& limits);
  /// Begins with a track. Nothing is estimated where the caller gave the identity, or has
  /// every frame estimate it.
  void (*start)(TrackerParts& tracker, const TrackerOptions& options);
  /// Ends a good frame whose observations are still there: takes it into the estimate, chooses a step towards the
  /// estimate, prepares it, or takes it. What is due waits for a frame whose budget has room for it.
  void (*conclude)(TrackerParts& tracker);
};

}  // namespace pliant
