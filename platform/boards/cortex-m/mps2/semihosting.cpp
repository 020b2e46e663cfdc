// The board's log and files, by ARM semihosting: a debugger or an emulator carries them out on its host.
#include <cstdint>
#include <cstring>

#include "board.h"

namespace {

enum Operation { kOpen = 0x01, kWrite0 = 0x04, kRead = 0x06, kExitExtended = 0x20 };

std::uintptr_t call(Operation operation, const void* argument) {
  register std::uintptr_t r0 __asm("r0") = operation;
  register const void* r1 __asm("r1") = argument;
  __asm volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
}

}  // namespace

void board_write(const char* text) {
  call(kWrite0, text);
}

void board_exit(int code) {
  constexpr std::uintptr_t kApplicationExit = 0x20026;
  const std::uintptr_t block[2] = {kApplicationExit, static_cast<std::uintptr_t>(code)};
  call(kExitExtended, block);
  for (;;) {
  }
}

int board_open(const char* path) {
  constexpr std::uintptr_t kReadBinary = 1;
  const std::uintptr_t block[3] = {reinterpret_cast<std::uintptr_t>(path), kReadBinary, std::strlen(path)};
  return static_cast<int>(call(kOpen, block));
}

std::size_t board_read(int file, void* to, std::size_t bytes) {
  const std::uintptr_t block[3] = {static_cast<std::uintptr_t>(file), reinterpret_cast<std::uintptr_t>(to),
                                   bytes};
  return bytes - call(kRead, block);  // the call gives what was not read
}
