// PLIANT_ASSERT as a release build sees it.
#ifndef NDEBUG
#define NDEBUG
#endif
#include "pliant/status.hpp"

int evaluations_in_release() {
  int count = 0;
  const auto is_evaluated = [&count] { return ++count == 0; };
  PLIANT_ASSERT(is_evaluated());
  return count;
}
