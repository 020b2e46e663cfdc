#pragma once
/// \file interrupt.hpp
/// Turns Ctrl-C into a flag, so that a command can finish its files.
#include <csignal>
#include <cstddef>

namespace pliant::host {

/// While an object of this class exists, the first SIGINT, SIGTERM or SIGHUP only sets a flag; a second one has the effect that it
/// had before. One that is ignored (nohup, a script's background) stays so. There may be one object at a time.
class InterruptWatch {
 public:
  InterruptWatch() {
    flag() = 0;
    for (std::size_t k = 0; k < kCount; ++k)
      if ((before()[k] = std::signal(kSignals[k], note)) == SIG_IGN) std::signal(kSignals[k], SIG_IGN);
  }
  ~InterruptWatch() { restore(); }
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;

  bool was_interrupted() const { return flag() != 0; }

 private:
  using Handler = void (*)(int);
  static constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP};
  static constexpr std::size_t kCount = sizeof kSignals / sizeof *kSignals;

  static void note(int) {
    flag() = 1;
    restore();
  }
  static void restore() {
    for (std::size_t k = 0; k < kCount; ++k) std::signal(kSignals[k], before()[k]);
  }
  static volatile std::sig_atomic_t& flag() {
    static volatile std::sig_atomic_t raised = 0;
    return raised;
  }
  static Handler* before() {
    static Handler handlers[kCount] = {};
    return handlers;
  }
};

}  // namespace pliant::host
