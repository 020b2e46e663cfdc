#pragma once
// Two 16-bit integers in one 32-bit register: the DSP instructions of Arm, which Cortex-M4, M7 and M33 have
// instead of vectors. Elsewhere the same operations in plain code, so that tests can compare on every target.
#include <cstring>

#include "vision/patch_arrays.hpp"

#if defined(__ARM_FEATURE_SIMD32) && !defined(__ARM_NEON)
#include <arm_acle.h>
#define PLIANT_HAS_HALFWORDS 1
#else
#define PLIANT_HAS_HALFWORDS 0
#endif

namespace pliant::patch {

/// The lower half is the first element in memory.
using Pair = i32;

inline Pair load_pair(const i16* at) {
  Pair p;
  std::memcpy(&p, at, sizeof p);
  return p;
}
inline std::uint32_t load_bytes(const void* at) {
  std::uint32_t word;
  std::memcpy(&word, at, sizeof word);
  return word;
}
inline void store_pair(Pair p, i16* at) {
  std::memcpy(at, &p, sizeof p);
}
/// Loads four elements and moves on to the next. Precondition: `at` is aligned to four bytes.
[[gnu::always_inline]] inline void take_four(const i16*& at, Pair& first, Pair& second) {
#if PLIANT_HAS_HALFWORDS && defined(__thumb2__)
  __asm__ volatile("ldrd %0, %1, [%2], #8" : "=&r"(first), "=&r"(second), "+&r"(at) : : "memory");
#else
  first = load_pair(at);
  second = load_pair(at + 2);
  at += 4;
#endif
}
constexpr Pair pair_of(i32 low, i32 high) {
  return static_cast<Pair>((static_cast<std::uint32_t>(low) & 0xffffu) | static_cast<std::uint32_t>(high)
                                                                             << 16);
}
constexpr i16 low(Pair p) {
  return narrow(p);
}
constexpr i16 high(Pair p) {
  return narrow(p >> 16);
}

#if PLIANT_HAS_HALFWORDS

inline Pair add(Pair p, Pair q) {
  return __sadd16(p, q);
}
inline Pair subtract(Pair p, Pair q) {
  return __ssub16(p, q);
}
/// (p + q) >> 1, without overflow.
inline Pair half_sum(Pair p, Pair q) {
  return __shadd16(p, q);
}
/// before + low p * low q + high p * high q.
inline i32 add_products(Pair p, Pair q, i32 before) {
  return __smlad(p, q, before);
}
/// before + low p * low q - high p * high q.
inline i32 add_difference(Pair p, Pair q, i32 before) {
  return __smlsd(p, q, before);
}
/// Upper element of p times lower element of q. GCC 12 has no name for this instruction, and shifts before it
/// multiplies.
inline i32 product_high_low(Pair p, Pair q) {
  i32 product;
  __asm__("smultb %0, %1, %2" : "=r"(product) : "r"(p), "r"(q));
  return product;
}
/// Elements cut off to 12 bits with sign.
inline Pair saturated12(Pair p) {
  return __ssat16(p, 12);
}
/// before + the bytes 0 and 2 of a word; bytes 1 and 3.
inline Pair add_even_bytes(Pair before, std::uint32_t word) {
  return static_cast<Pair>(__uxtab16(static_cast<std::uint32_t>(before), word));
}
inline Pair add_odd_bytes(Pair before, std::uint32_t word) {
  Pair p;
  __asm__("uxtab16 %0, %1, %2, ror #8" : "=r"(p) : "r"(before), "r"(word));
  return p;
}
/// The bytes 0 and 2 of a word, with their signs; bytes 1 and 3.
inline Pair signed_even_bytes(std::uint32_t word) {
  return __sxtb16(static_cast<Pair>(word));
}
inline Pair signed_odd_bytes(std::uint32_t word) {
  Pair p;
  __asm__("sxtb16 %0, %1, ror #8" : "=r"(p) : "r"(word));
  return p;
}
/// before + all four bytes of a word.
inline std::uint32_t add_bytes(std::uint32_t before, std::uint32_t word) {
  return __usada8(word, 0, before);
}
/// The lower halves of a >> n and b >> n, 0 < n < 16.
template <int n>
inline Pair shifted(i32 a, i32 b) {
  Pair p;
  __asm__("pkhbt %0, %1, %2, lsl %3" : "=r"(p) : "r"(a >> n), "r"(b), "i"(16 - n));
  return p;
}
/// The lower halves; the upper halves.
inline Pair lowers(i32 a, i32 b) {
  Pair p;
  __asm__("pkhbt %0, %1, %2, lsl #16" : "=r"(p) : "r"(a), "r"(b));
  return p;
}
inline Pair uppers(i32 a, i32 b) {
  Pair p;
  __asm__("pkhtb %0, %1, %2, asr #16" : "=r"(p) : "r"(b), "r"(a));
  return p;
}

#else

inline Pair add(Pair p, Pair q) {
  return pair_of(low(p) + low(q), high(p) + high(q));
}
inline Pair subtract(Pair p, Pair q) {
  return pair_of(low(p) - low(q), high(p) - high(q));
}
inline Pair half_sum(Pair p, Pair q) {
  return pair_of((low(p) + low(q)) >> 1, (high(p) + high(q)) >> 1);
}
inline i32 add_products(Pair p, Pair q, i32 before) {
  return before + low(p) * low(q) + high(p) * high(q);
}
inline i32 add_difference(Pair p, Pair q, i32 before) {
  return before + low(p) * low(q) - high(p) * high(q);
}
inline i32 product_high_low(Pair p, Pair q) {
  return high(p) * low(q);
}
inline Pair saturated12(Pair p) {
  const auto cut = [](i32 v) { return v < -2048 ? -2048 : v > 2047 ? 2047 : v; };
  return pair_of(cut(low(p)), cut(high(p)));
}
inline Pair add_even_bytes(Pair before, std::uint32_t word) {
  return before + static_cast<Pair>(word & 0x00ff00ffu);
}
inline Pair add_odd_bytes(Pair before, std::uint32_t word) {
  return before + static_cast<Pair>(word >> 8 & 0x00ff00ffu);
}
inline Pair signed_even_bytes(std::uint32_t word) {
  return pair_of(static_cast<std::int8_t>(word), static_cast<std::int8_t>(word >> 16));
}
inline Pair signed_odd_bytes(std::uint32_t word) {
  return signed_even_bytes(word >> 8);
}
inline std::uint32_t add_bytes(std::uint32_t before, std::uint32_t word) {
  return before + (word & 255u) + (word >> 8 & 255u) + (word >> 16 & 255u) + (word >> 24);
}
template <int n>
inline Pair shifted(i32 a, i32 b) {
  return pair_of(a >> n, b >> n);
}
inline Pair lowers(i32 a, i32 b) {
  return pair_of(a, b);
}
inline Pair uppers(i32 a, i32 b) {
  return pair_of(a >> 16, b >> 16);
}

#endif

/// `mulhi` of both elements and t.
inline Pair mulhi(Pair p, i16 t) {
  return uppers(i32{low(p)} * t, product_high_low(p, t));
}
/// Products of the elements, shifted right by n.
template <int n>
inline Pair product(Pair p, Pair q) {
  return shifted<n>(i32{low(p)} * low(q), i32{high(p)} * high(q));
}

}  // namespace pliant::patch
