#pragma once
// What the main functions of programs that read files share.
#include <iostream>

#include "host/io/failure.hpp"

namespace pliant {

/// Runs a program. Bad input is told in one line, and gives the exit code.
inline int run_program(const char* name, int (*run)(int count, char** words), int count, char** words) {
  try {
    return run(count, words);
  } catch (const host::Failure& failure) {
    std::cerr << name << ": " << failure.what() << "\n";
    return failure.exit_code();
  }
}

}  // namespace pliant
