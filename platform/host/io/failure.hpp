#pragma once
/// \file failure.hpp
/// The exception that ends a command. `run` (command.hpp) turns it into one line and an exit code.
#include <stdexcept>
#include <string>

#include "pliant/status.hpp"

namespace pliant::host {

constexpr int kBadInput = 1;  ///< exit code: a file cannot be read or written, or its contents are invalid
constexpr int kBadUsage = 2;  ///< exit code: the command line is invalid
constexpr int kInterrupted = 130;  ///< exit code: Ctrl-C ended the command, and what there was is written

class Failure : public std::runtime_error {
 public:
  Failure(int exit_code, const std::string& message) : std::runtime_error(message), exit_code_(exit_code) {}
  int exit_code() const { return exit_code_; }

 private:
  int exit_code_;
};

/// "`where`: `what`", exit code 1. `where` names the file, and the line and column if known.
[[noreturn]] inline void fail_input(const std::string& where, const std::string& what) {
  throw Failure(kBadInput, where + ": " + what);
}
[[noreturn]] inline void fail_usage(const std::string& what) {
  throw Failure(kBadUsage, what);
}

/// Throws bad input at `where` unless the status is ok.
inline void require(Status status, const std::string& where) {
  if (status != Status::ok) fail_input(where, text(status));
}

}  // namespace pliant::host
