#pragma once
/// \file command.hpp
/// The `pliant` program: its commands, and a function that runs them.
#include <chrono>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "host/commands/args.hpp"

namespace pliant::host {

/// Output streams of a command.
struct Console {
  std::ostream& out;            ///< results
  std::ostream& err;            ///< errors, notes, progress
  bool shows_progress = false;  ///< err is a terminal
};

struct Command {
  const char* name;
  const char* summary;
  const char* usage;  ///< what follows "pliant NAME"
  std::vector<Option> options;
  std::size_t operands;                            ///< number of positional words
  int (*run)(const Args& args, Console& console);  ///< \return the exit code; throws Failure
  std::size_t optional_operands = 0;               ///< number of further positional words that are allowed
};

Command bake_command();
Command info_command();
Command mesh_command();
Command points_command();
Command fit_command();
Command detect_command();
Command learn_command();
Command track_command();
Command animate_command();
Command render_command();
Command camera_command();
Command plan_command();
Command bench_command();

/// Runs a command line, without the program's name. Never throws.
/// \return 0 on success, 2 on bad usage, 1 on bad input or if the output cannot be written; then one line on `err` names the
///         file and what is wrong.
int run(const std::vector<std::string>& words, Console& console);

/// A counter that overwrites itself on a terminal; elsewhere it prints nothing.
class Progress {
 public:
  /// \param of  the count at the end, so that the time left can be told; 0: unknown.
  Progress(Console& console, const char* what, std::size_t of = 0)
      : console_(console), what_(what), of_(of), began_(std::chrono::steady_clock::now()) {}
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void show(std::size_t count);
  /// Prints a line of its own, which the counter does not overwrite.
  void note(const std::string& line);

 private:
  std::string time_left(std::size_t count) const;

  Console& console_;
  const char* what_;
  std::size_t of_;
  std::chrono::steady_clock::time_point began_;
  bool shown_ = false;
};

/// Shows each stage of a command with a counter of its own; also a stage that begins again.
class StageProgress {
 public:
  explicit StageProgress(Console& console) : console_(console) {}
  void show(const char* stage, std::size_t done, std::size_t of);
  /// Ends the counter's line.
  void finish() { counter_.reset(); }

 private:
  Console& console_;
  std::string stage_;
  std::size_t done_ = 0, of_ = 0;
  std::unique_ptr<Progress> counter_;
};

}  // namespace pliant::host
