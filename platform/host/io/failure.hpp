#pragma once
/// \file failure.hpp
/// How a command ends early. Host code throws it; `run` (command.hpp) turns it into one line and an exit
/// code.
#include <stdexcept>
#include <string>

#include "pliant/status.hpp"

namespace pliant::host {

constexpr int kBadInput = 1;  ///< a file that cannot be read or says something impossible
constexpr int kBadUsage = 2;  ///< an option that does not exist, or a missing one

class Failure : public std::runtime_error {
 public:
  Failure(int exit_code, const std::string& message) : std::runtime_error(message), exit_code_(exit_code) {}
  int exit_code() const { return exit_code_; }

 private:
  int exit_code_;
};

/// "`where`: `what`", exit code 1. `where` names the file, and the line and column where there are some.
[[noreturn]] inline void fail_input(const std::string& where, const std::string& what) {
  throw Failure(kBadInput, where + ": " + what);
}
[[noreturn]] inline void fail_usage(const std::string& what) {
  throw Failure(kBadUsage, what);
}

/// Passes `ok`; anything else is bad input at `where`.
inline void require(Status status, const std::string& where) {
  if (status != Status::ok) fail_input(where, text(status));
}

}  // namespace pliant::host
