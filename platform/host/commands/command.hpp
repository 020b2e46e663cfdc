#pragma once
/// \file command.hpp
/// The `pliant` command: its sub-commands and how they are run.
#include <ostream>
#include <string>
#include <vector>

#include "host/commands/args.hpp"

namespace pliant::host {

/// Where a command talks to.
struct Console {
  std::ostream& out;            ///< results
  std::ostream& err;            ///< complaints, notes, progress
  bool shows_progress = false;  ///< err is a terminal
};

struct Command {
  const char* name;
  const char* summary;
  const char* usage;  ///< what follows "pliant NAME"
  std::vector<Option> options;
  std::size_t operands;                            ///< positional words
  int (*run)(const Args& args, Console& console);  ///< \return the exit code; throws Failure
  std::size_t optional_operands = 0;               ///< and so many more may follow
};

Command bake_command();
Command info_command();
Command mesh_command();
Command points_command();
Command fit_command();
Command track_command();
Command animate_command();
Command render_command();
Command camera_command();
Command plan_command();
Command bench_command();

/// Runs a whole command line (without the program's name). \return 0 on success, 2 on bad usage, 1 on bad
/// input; then one line on `err` says what is wrong and where. Never throws.
int run(const std::vector<std::string>& words, Console& console);

/// A counter that overwrites itself on a terminal, and is silent elsewhere.
class Progress {
 public:
  Progress(Console& console, const char* what) : console_(console), what_(what) {}
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void show(std::size_t count);

 private:
  Console& console_;
  const char* what_;
  bool shown_ = false;
};

}  // namespace pliant::host
