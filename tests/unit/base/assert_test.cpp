// PLIANT_ASSERT as a debug build sees it; assert_off.cpp has the release build's.
#undef NDEBUG
#include <doctest/doctest.h>

#include <csetjmp>
#include <csignal>

#include "pliant/status.hpp"

int evaluations_in_release();

namespace assert_test {

namespace {

sigjmp_buf after_trap;

void leave(int) {
  siglongjmp(after_trap, 1);
}

// True where the check stopped the program. The instruction of a trap differs: so does the signal.
bool traps(bool condition) {
  constexpr int kSignals[] = {SIGILL, SIGTRAP, SIGABRT};
  struct sigaction mine = {}, before[3];
  mine.sa_handler = leave;
  for (int i = 0; i < 3; ++i) sigaction(kSignals[i], &mine, &before[i]);
  volatile bool has_trapped = true;
  if (sigsetjmp(after_trap, 1) == 0) {
    PLIANT_ASSERT(condition);
    has_trapped = false;
  }
  for (int i = 0; i < 3; ++i) sigaction(kSignals[i], &before[i], nullptr);
  return has_trapped;
}

}  // namespace

TEST_CASE("in a debug build a condition that does not hold stops the program") {
  CHECK(traps(false));
  CHECK_FALSE(traps(true));
}

TEST_CASE("in a debug build a condition is evaluated once") {
  int count = 0;
  PLIANT_ASSERT(++count == 1);
  CHECK(count == 1);
}

TEST_CASE("in a release build a condition is not evaluated") {
  CHECK(evaluations_in_release() == 0);
}

}  // namespace assert_test
