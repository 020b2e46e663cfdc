// The board's log and files on a host.
#include "board.h"

#include <cstdint>
#include <cstdio>
#include <cstdlib>

namespace {
std::FILE* files[8];
}

void board_write(const char* text) {
  std::fputs(text, stdout);
}

void board_exit(int code) {
  std::exit(code);
}

int board_open(const char* path) {
  for (int k = 0; k < 8; ++k)
    if (files[k] == nullptr) {
      files[k] = std::fopen(path, "rb");
      return files[k] == nullptr ? -1 : k;
    }
  return -1;
}

std::size_t board_read(int file, void* to, std::size_t bytes) {
  return std::fread(to, 1, bytes, files[file]);
}

std::uint32_t board_ticks() {
  return 0;
}

std::size_t board_stack_bytes() {
  return 0;
}

std::size_t board_worst_stack_bytes() {
  return 0;
}
