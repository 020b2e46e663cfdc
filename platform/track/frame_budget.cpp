#include "track/frame_budget.hpp"

#include "pliant/geometry.hpp"

namespace pliant {

void FrameBudget::begin(bool reserves) {
  work = {};
  reserved = 0;
  kind = nullptr;
  WaitingWork* const all[] = {&check, &key_frame, &person, &second_look};
  for (WaitingWork* waiting : all) {
    const bool is_first = kind == nullptr && waiting->waited >= kFrameBudgetTuning.most_waited;
    if (is_first) kind = waiting;
    waiting->is_reserved = is_first && reserves;
    if (waiting->is_reserved) reserved = min(waiting->work, most_reserved());
  }
}

float FrameBudget::left() const {
  return most - reserved - costs.of(work);
}

float FrameBudget::left_for_searches() const {
  const FrameBudgetTuning& t = kFrameBudgetTuning;
  const float all = t.most_of_searches * (left() + reserved);
  return max(min(all, t.most_of_searches_if_reserved * left()), 0);
}

void FrameBudget::give_half_to(const WaitingWork& of) {
  check.is_reserved = key_frame.is_reserved = person.is_reserved = second_look.is_reserved = false;
  reserved = 0;
  kind = &of;
  work.rare += most_reserved();
}

bool FrameBudget::take_now(const WaitingWork& of, float instructions) {
  if (instructions > left_for(of)) return false;
  kind = &of;
  work.rare += instructions;
  return true;
}

bool FrameBudget::take(WaitingWork& waiting, float instructions, float if_overdue) {
  if (waiting.is_reserved) {
    reserved = 0;
  } else if (!is_free_for(waiting) || instructions > left()) {
    waiting.work = if_overdue;
    ++waiting.waited;
    return false;
  }
  kind = &waiting;
  work.rare += instructions;
  waiting = {};
  return true;
}

}  // namespace pliant
