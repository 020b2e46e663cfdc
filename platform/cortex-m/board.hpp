#pragma once
// What the programs of this folder ask of a board. mps2/ answers by semihosting on a Cortex-M7, host/ by standard input
// and output, so that the same program runs on both; your board answers with its own serial line and camera.
#include <cstddef>
#include <cstdint>

namespace board {

/// Writes text that ends in a zero to the log.
void write(const char* text);

/// Ends the program; 0 is success.
[[noreturn]] void exit(int code);

/// Opens a file for reading, where the board has files: a handle, or -1.
int open(const char* path);
/// Bytes read; fewer than asked at the end of the file.
std::size_t read(int file, void* to, std::size_t bytes);

/// Instructions executed so far, in steps of `kInstructionsPerTick`, modulo 2^24 steps; 0 where nobody counts.
std::uint32_t ticks();
constexpr std::uint32_t kInstructionsPerTick = 40;
constexpr std::uint32_t kTickMask = 0xffffff;

/// The deepest the stack has been, and what there is of it; both 0 where it was not painted.
std::size_t worst_stack_bytes();
std::size_t stack_bytes();

}  // namespace board
