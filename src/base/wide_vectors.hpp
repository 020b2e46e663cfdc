#pragma once
/// \file wide_vectors.hpp
/// Kernels that are compiled for wider vectors, too, and chosen when the program is loaded.
#include <cstdint>  // tells which C library there is

/// Before a function over whole arrays. With GCC on x86-64 Linux it is compiled for AVX2 as well, and the loader takes the one that
/// the processor has: 500 templates of 15 x 15 px then take two thirds of the time (docs/evaluation.md, Template matching). All
/// that it calls is inlined, and must be: in a function of narrow vectors that is called from it, every instruction waits for the
/// upper halves (a sixth of the time of template matching, once). Elsewhere it means nothing. Of floats only element by element:
/// a sum over an array would depend on the width of the vectors. Not with the address or thread sanitizer, which do not run yet
/// when the loader chooses.
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define PLIANT_WIDE_VECTORS __attribute__((target_clones("avx2", "default"), flatten))
#else
#define PLIANT_WIDE_VECTORS
#endif
