// From reset to main on a Cortex-M: floating point on, stack painted, data copied, bss cleared, constructors run.
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "board.h"

int main();

extern "C" {
extern std::uint32_t stack_bottom[], stack_painted[], stack_top[];
extern unsigned char data_in_flash[], data_begin[], data_end[], bss_begin[], bss_end[];
using Constructor = void (*)();
extern const Constructor init_array_begin[], init_array_end[];
[[noreturn]] void reset();
[[noreturn]] void fault();
}

namespace {

constexpr std::uint32_t kPaint = 0xa5c3f00d;

volatile std::uint32_t& memory_register(std::uintptr_t address) {
  return *reinterpret_cast<volatile std::uint32_t*>(address);
}

/// Nothing but the reset itself happens here before floating point is on.
void enable_floating_point() {
  constexpr std::uintptr_t kAccessControl = 0xe000ed88;
  memory_register(kAccessControl) = memory_register(kAccessControl) | (0xfu << 20);
  __asm volatile("dsb\n isb" ::: "memory");
}

void start_ticks() {
  constexpr std::uintptr_t kControl = 0xe000e010, kReload = 0xe000e014, kValue = 0xe000e018;
  memory_register(kReload) = BOARD_TICK_MASK;
  memory_register(kValue) = 0;
  memory_register(kControl) = 5;  // on, processor clock, no interrupt
}

std::size_t bytes_between(const void* begin, const void* end) {
  return static_cast<std::size_t>(static_cast<const char*>(end) - static_cast<const char*>(begin));
}

}  // namespace

using Entry = void (*)();

/// Initial stack pointer; then reset and the processor's exceptions. This program uses no interrupt.
extern "C"
    [[gnu::section(".vectors"), gnu::used]] const Entry vectors[16] = {reinterpret_cast<Entry>(stack_top),
                                                                       reset,
                                                                       fault,
                                                                       fault,
                                                                       fault,
                                                                       fault,
                                                                       fault,
                                                                       nullptr,
                                                                       nullptr,
                                                                       nullptr,
                                                                       nullptr,
                                                                       fault,
                                                                       fault,
                                                                       nullptr,
                                                                       fault,
                                                                       fault};

void reset() {
  enable_floating_point();
  for (std::uint32_t* p = stack_bottom; p < stack_painted; ++p) *p = kPaint;
  std::memcpy(data_begin, data_in_flash, bytes_between(data_begin, data_end));
  std::memset(bss_begin, 0, bytes_between(bss_begin, bss_end));
  for (const Constructor* c = init_array_begin; c < init_array_end; ++c) (*c)();
  start_ticks();
  board_exit(main());
}

void fault() {
  board_write("fault\n");
  board_exit(3);
}

std::uint32_t board_ticks() {
  return BOARD_TICK_MASK - memory_register(0xe000e018);
}

std::size_t board_stack_bytes() {
  return bytes_between(stack_bottom, stack_top);
}

std::size_t board_worst_stack_bytes() {
  const std::uint32_t* p = stack_bottom;
  while (p < stack_top && *p == kPaint) ++p;
  return bytes_between(p, stack_top);
}
