#include "host/io/child_process.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <utility>

#include "host/io/words.hpp"

extern char** environ;

namespace pliant::host {

namespace {

/// The last line of a file that is not blank and has `part` in it; empty if there is none.
std::string last_line(std::FILE* file, std::string_view part) {
  constexpr long kEnd = 4096;  // bytes; lines of an error message are shorter
  if (std::fseek(file, -kEnd, SEEK_END) != 0) std::rewind(file);
  char bytes[kEnd];
  std::string_view text(bytes, std::fread(bytes, 1, sizeof bytes, file));
  while (!text.empty()) {
    const std::size_t before = text.rfind('\n');
    const std::string line = trimmed(text.substr(before + 1));
    if (!line.empty() && line.find(part) != std::string::npos) return line;
    text = text.substr(0, before == std::string_view::npos ? 0 : before);
  }
  return "";
}

}  // namespace

std::unique_ptr<ChildProcess> ChildProcess::start(const std::vector<std::string>& words, Pipe pipe,
                                                  const std::string& input) {
  int ends[2];
  std::FILE* errors =
      ::fdopen(::memfd_create("errors", MFD_CLOEXEC), "w+b");  // a device may have no folder to write to
  if (errors == nullptr || ::pipe2(ends, O_CLOEXEC) != 0) {
    if (errors != nullptr) std::fclose(errors);
    return nullptr;
  }
  const bool reads = pipe == Pipe::from_output;
  const int ours = ends[reads ? 0 : 1], theirs = ends[reads ? 1 : 0];
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, theirs, reads ? STDOUT_FILENO : STDIN_FILENO);
  posix_spawn_file_actions_addopen(&actions, reads ? STDIN_FILENO : STDOUT_FILENO,
                                   reads ? input.c_str() : "/dev/null", reads ? O_RDONLY : O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, ::fileno(errors), STDERR_FILENO);
  // A program that is written to ends with its input, not with Ctrl-C, which ends the track.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  if (!reads) posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  pid_t id = -1;
  const int error = ::posix_spawnp(&id, arguments[0], &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  ::close(theirs);
  std::FILE* stream = error == 0 ? ::fdopen(ours, reads ? "rb" : "wb") : nullptr;
  if (stream != nullptr) return std::unique_ptr<ChildProcess>(new ChildProcess(id, stream, errors));
  ::close(ours);
  std::fclose(errors);
  return nullptr;
}

std::string ChildProcess::finish() {
  if (stream_ != nullptr) std::fclose(std::exchange(stream_, nullptr));
  int status = 0;
  while (id_ > 0 && ::waitpid(id_, &status, 0) < 0 && errno == EINTR) {
  }
  id_ = -1;
  if (status == 0) return "";
  const std::string line = last_error();
  return line.empty() ? "failed" : line;
}

std::string ChildProcess::last_error(std::string_view part) {
  return last_line(errors_, part);
}

ChildProcess::~ChildProcess() {
  if (id_ > 0) ::kill(id_, SIGTERM);
  finish();
  std::fclose(errors_);
}

}  // namespace pliant::host
