#include <fcntl.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <iostream>

#include "host/commands/command.hpp"

int main(int argc, char** argv) {
  // Where standard error is closed the first file opened would become it, and get its messages. A write to a closed standard output
  // must fail.
  for (int fd = 0; fd <= STDERR_FILENO; ++fd)
    if (fcntl(fd, F_GETFD) < 0 && open("/dev/null", fd == STDERR_FILENO ? O_WRONLY : O_RDONLY) < 0) break;
  setenv("LIBCAMERA_LOG_LEVELS", "*:WARN", 0);  // without its greeting, unless someone asks for it
  // A reader that goes away, and a file that grows beyond a limit, are failed writes, which are told.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  pliant::host::Console console{std::cout, std::cerr, isatty(STDERR_FILENO) != 0};
  return pliant::host::run(std::vector<std::string>(argv + 1, argv + argc), console);
}
