#pragma once
/// \file interrupt.hpp
/// Turns Ctrl-C into a flag, so that a command can finish its files.
#include <csignal>

namespace pliant::host {

/// While an object of this class exists, SIGINT and SIGTERM only set a flag. There may be one object at a time.
class InterruptWatch {
 public:
  /// \param is_on  if false, the signals keep their usual effect.
  explicit InterruptWatch(bool is_on) : is_on_(is_on) {
    if (!is_on_) return;
    flag() = 0;
    before_[0] = std::signal(SIGINT, [](int) { flag() = 1; });
    before_[1] = std::signal(SIGTERM, [](int) { flag() = 1; });
  }
  ~InterruptWatch() {
    if (!is_on_) return;
    std::signal(SIGINT, before_[0]);
    std::signal(SIGTERM, before_[1]);
  }
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;

  bool was_interrupted() const { return is_on_ && flag() != 0; }

 private:
  static volatile std::sig_atomic_t& flag() {
    static volatile std::sig_atomic_t raised = 0;
    return raised;
  }
  bool is_on_;
  void (*before_[2])(int) = {};
};

}  // namespace pliant::host
