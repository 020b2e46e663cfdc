/**
 * What the programs of this folder ask of a board, in C and C++. mps2/ answers by semihosting on a Cortex-M7, host/ by
 * standard input and output, so that the same program runs on both; your board answers with its own serial line and camera.
 */
#ifndef BOARD_H
#define BOARD_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Writes text that ends in a zero to the log. */
void board_write(const char *text);

/** Ends the program; 0 is success. */
#ifdef __cplusplus
[[noreturn]]
#else
_Noreturn
#endif
void board_exit(int code);

/** Opens a file for reading, where the board has files: a handle, or -1. */
int board_open(const char *path);
/** Bytes read; fewer than asked at the end of the file. */
size_t board_read(int file, void *to, size_t bytes);

/** Instructions executed so far, in steps of BOARD_INSTRUCTIONS_PER_TICK, modulo 2^24 steps; 0 where the board has no counter. */
uint32_t board_ticks(void);
#define BOARD_INSTRUCTIONS_PER_TICK 40u
#define BOARD_TICK_MASK 0xffffffu

/** The deepest the stack has been, and what there is of it; both 0 where it was not painted. */
size_t board_worst_stack_bytes(void);
size_t board_stack_bytes(void);

#ifdef __cplusplus
}
#endif

#endif
