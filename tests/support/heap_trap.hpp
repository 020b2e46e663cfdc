#pragma once
// Counts every heap call of the program while armed: malloc and its relatives, and through them operator new. Works with
// glibc; under a sanitizer, which needs malloc for itself, only operator new is counted.
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <new>

#include "sanitized.hpp"

namespace heap_trap {
inline volatile bool armed = false;
inline volatile int calls = 0;
inline void note() {
  if (armed) calls = calls + 1;
}
/// Armed for its lifetime.
struct Armed {
  Armed() {
    calls = 0;
    armed = true;
  }
  ~Armed() { armed = false; }
};
}  // namespace heap_trap

#if defined(__GLIBC__) && !defined(PLIANT_TEST_SANITIZED)
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);
void* malloc(std::size_t n) {
  heap_trap::note();
  return __libc_malloc(n);
}
void* calloc(std::size_t n, std::size_t m) {
  heap_trap::note();
  return __libc_calloc(n, m);
}
void* realloc(void* p, std::size_t n) {
  heap_trap::note();
  return __libc_realloc(p, n);
}
void* memalign(std::size_t a, std::size_t n) {
  heap_trap::note();
  return __libc_memalign(a, n);
}
void* aligned_alloc(std::size_t a, std::size_t n) {
  heap_trap::note();
  return __libc_memalign(a, n);
}
int posix_memalign(void** out, std::size_t a, std::size_t n) {
  heap_trap::note();
  void* const p = __libc_memalign(a, n);
  if (p == nullptr) return ENOMEM;
  *out = p;
  return 0;
}
void free(void* p) {
  heap_trap::note();
  __libc_free(p);
}
}
#else
void* operator new(std::size_t n) {
  heap_trap::note();
  void* p = std::malloc(n);
  if (p == nullptr) std::abort();
  return p;
}
void operator delete(void* p) noexcept {
  heap_trap::note();
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
  heap_trap::note();
  std::free(p);
}
#endif
