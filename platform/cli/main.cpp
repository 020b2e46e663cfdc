#include <unistd.h>

#include <iostream>

#include "cli/command.hpp"

int main(int argc, char** argv) {
  pliant::cli::Console console{std::cout, std::cerr, isatty(STDERR_FILENO) != 0};
  return pliant::cli::run(std::vector<std::string>(argv + 1, argv + argc), console);
}
