#pragma once
/// \file child_process.hpp
/// Another program, run with a pipe from its standard output or to its standard input.
#include <sys/types.h>

#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace pliant::host {

class ChildProcess {
 public:
  enum class Pipe { from_output, to_input };

  /// Starts the program `words[0]`, which is looked for along PATH, with the other words as its arguments. There is no shell.
  /// \param input  the file that is its standard input where there is no pipe to it; by default an empty one.
  /// \return null if there is no such program or it cannot be started.
  static std::unique_ptr<ChildProcess> start(const std::vector<std::string>& words, Pipe pipe,
                                             const std::string& input = "/dev/null");

  /// Ends the program if it still runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// This side of the pipe. Open until `finish`.
  std::FILE* stream() const { return stream_; }
  /// Closes the pipe and waits for the program's end. \return the last line that the program wrote to standard error if it
  /// failed, "failed" if it wrote none; empty on success.
  std::string finish();
  /// The last line that the program has written to standard error, whether it failed or not; empty without one.
  /// \param part  that the line has in it.
  std::string last_error(std::string_view part = "");

 private:
  ChildProcess(pid_t id, std::FILE* stream, std::FILE* errors) : id_(id), stream_(stream), errors_(errors) {}

  pid_t id_;
  std::FILE* stream_;
  std::FILE* errors_;
};

}  // namespace pliant::host
