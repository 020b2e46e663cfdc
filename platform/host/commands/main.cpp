#include <unistd.h>

#include <cstdlib>
#include <iostream>

#include "host/commands/command.hpp"

int main(int argc, char** argv) {
  setenv("LIBCAMERA_LOG_LEVELS", "*:WARN", 0);  // without its greeting, unless someone asks for it
  pliant::host::Console console{std::cout, std::cerr, isatty(STDERR_FILENO) != 0};
  return pliant::host::run(std::vector<std::string>(argv + 1, argv + argc), console);
}
