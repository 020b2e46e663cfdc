#pragma once
/// \file interrupt.hpp
/// Turns Ctrl-C into a flag, so that a command can finish its files.
#include <signal.h>

#include <cstddef>

namespace pliant::host {

/// While an object of this class exists, the first SIGINT, SIGTERM or SIGHUP only sets a flag, and ends a read that waits for input
/// (errno EINTR); a second one has the effect that it had before. One that is ignored (nohup, a script's background) stays so.
/// There may be one object at a time.
class InterruptWatch {
 public:
  InterruptWatch() {
    flag() = 0;
    struct sigaction noting {};
    noting.sa_handler = note;  // without SA_RESTART
    for (std::size_t k = 0; k < kCount; ++k) {
      ::sigaction(kSignals[k], nullptr, &before()[k]);
      if (before()[k].sa_handler != SIG_IGN) ::sigaction(kSignals[k], &noting, nullptr);
    }
  }
  ~InterruptWatch() { restore(); }
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;

  bool was_interrupted() const { return flag() != 0; }

 private:
  static constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP};
  static constexpr std::size_t kCount = sizeof kSignals / sizeof *kSignals;

  static void note(int) {
    flag() = 1;
    restore();
  }
  static void restore() {
    for (std::size_t k = 0; k < kCount; ++k) ::sigaction(kSignals[k], &before()[k], nullptr);
  }
  static volatile sig_atomic_t& flag() {
    static volatile sig_atomic_t raised = 0;
    return raised;
  }
  static struct sigaction* before() {
    static struct sigaction actions[kCount] = {};
    return actions;
  }
};

}  // namespace pliant::host
