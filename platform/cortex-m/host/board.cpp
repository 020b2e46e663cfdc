// The board's log and files on a host.
#include "board.hpp"

#include <cstdio>
#include <cstdlib>

namespace {
std::FILE* files[8];
}

void board::write(const char* text) {
  std::fputs(text, stdout);
}

void board::exit(int code) {
  std::exit(code);
}

int board::open(const char* path) {
  for (int k = 0; k < 8; ++k)
    if (files[k] == nullptr) {
      files[k] = std::fopen(path, "rb");
      return files[k] == nullptr ? -1 : k;
    }
  return -1;
}

std::size_t board::read(int file, void* to, std::size_t bytes) {
  return std::fread(to, 1, bytes, files[file]);
}

std::uint32_t board::ticks() {
  return 0;
}

std::size_t board::stack_bytes() {
  return 0;
}

std::size_t board::worst_stack_bytes() {
  return 0;
}
