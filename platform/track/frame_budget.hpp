#pragma once
/// \file frame_budget.hpp
/// What the loops of a frame may take together: coarse translation, searches, solves and rare work
/// (docs/algorithms.md, section 9.2).
#include "pliant/frame_work.hpp"

namespace pliant {

/// Tuning of the budget of a frame. Its size is in TrackerTuning. What other values gave: docs/experiments.md, Budget.
struct FrameBudgetTuning {
  /// Frames that rare work waits, count. Round value, not tuned.
  int most_waited = 4;
  /// Fraction of the budget that may be reserved. With 0.7, which a change of the person fits into, turned heads had larger errors.
  float most_reserved = 0.5f;
  /// Fraction of what the coarse translation leaves that searches may take: the rest is left to solves and rare work. With 0.8 a
  /// frame took more than twice the median.
  float most_of_searches = 0.55f;
  /// Searches take no more than this fraction of what reserved work leaves besides. With 0.55 turned heads had larger errors.
  float most_of_searches_if_reserved = 0.8f;
};
inline constexpr FrameBudgetTuning kFrameBudgetTuning{};

/// Rare work that may wait for a frame with room, but not for ever.
struct WaitingWork {
  float work = 0;            ///< of what is done once it is overdue; instructions, as WorkCosts
  int waited = 0;            ///< frames that had no room for it
  bool is_reserved = false;  ///< this frame has room for it

  /// It may wait no longer.
  void hurry(float instructions) { *this = {instructions, kFrameBudgetTuning.most_waited, false}; }
};

/// The budget of a frame. Rare work is granted what searches and solves have left, one kind of it a frame. What has waited too
/// long is reserved when a frame begins, up to a fraction of the budget: searches and solves of that frame may take less, and
/// other kinds wait.
struct FrameBudget {
  FrameWork work;  ///< of the last frame
  WorkCosts costs;
  float most = 0;      ///< of a frame; instructions, as WorkCosts
  float reserved = 0;  ///< of that
  WaitingWork check, key_frame, person, second_look;
  /// Of the rare work that this frame does, or that comes first; null: any.
  const WaitingWork* kind = nullptr;

  /// Nothing waits any more: another track begins.
  void forget_waiting() { check = key_frame = person = second_look = {}; }
  /// Begins a frame. One overdue work comes first, with what is reserved for it. \param reserves  false: nothing, since the frame
  /// may need all.
  void begin(bool reserves);
  float most_reserved() const { return kFrameBudgetTuning.most_reserved * most; }
  /// What is left, but for what is reserved.
  float left() const;
  /// What the searches may take of it. Not negative.
  float left_for_searches() const;
  bool is_free_for(const WaitingWork& of) const { return kind == nullptr || kind == &of; }
  /// What is left for a kind of rare work: nothing beside another kind.
  float left_for(const WaitingWork& of) const { return is_free_for(of) ? left() : 0.0f; }
  /// Rare work that a frame begins with: it takes half of the budget, and other kinds wait.
  void give_half_to(const WaitingWork& of);
  /// Counts rare work, if there is room for it.
  bool take_now(const WaitingWork& of, float instructions);
  /// The same of work that can wait: what is refused has waited a frame. \param if_overdue  what it takes once it has waited too
  /// long, and what is then reserved for it.
  bool take(WaitingWork& waiting, float instructions, float if_overdue);
  bool take(WaitingWork& waiting, float instructions) { return take(waiting, instructions, instructions); }
};

}  // namespace pliant
