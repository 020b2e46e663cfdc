#pragma once
// Four floats at a time. With SSE or NEON they are the compiler's vector type, elsewhere a struct of scalars: the vector type
// would go through memory there. The results are the same: only `sum` adds across lanes.
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace pliant {

constexpr std::size_t kLanes = 4;

#if defined(__SSE2__) || defined(__ARM_NEON)
#define PLIANT_HAS_VECTORS 1
constexpr bool kHasVectors = true;

typedef float Lanes __attribute__((vector_size(16)));

inline Lanes load(const float* at) {
  Lanes v;
  std::memcpy(&v, at, sizeof v);
  return v;
}
inline void store(Lanes v, float* at) {
  std::memcpy(at, &v, sizeof v);
}
inline Lanes splat(float x) {
  return Lanes{x, x, x, x};
}
inline float sum(Lanes v) {
  return (v[0] + v[1]) + (v[2] + v[3]);
}

/// Four signed integers of two bytes each, the first in the lowest bits.
inline Lanes to_lanes(std::uint64_t four) {
#if __has_builtin(__builtin_shufflevector)
  typedef std::int16_t Shorts __attribute__((vector_size(8)));
  typedef std::int32_t Integers __attribute__((vector_size(16)));
  Shorts v;
  std::memcpy(&v, &four, sizeof v);
  const auto twice = __builtin_shufflevector(v, v, 0, 0, 1, 1, 2, 2, 3, 3);
  return __builtin_convertvector(reinterpret_cast<Integers>(twice) >> 16, Lanes);
#else  // GCC before 12
  const auto at = [four](int k) { return static_cast<float>(static_cast<std::int16_t>(four >> (16 * k))); };
  return Lanes{at(0), at(1), at(2), at(3)};
#endif
}

/// -most where v is smaller, most where it is larger.
inline Lanes limited(Lanes v, float most) {
  const Lanes high = splat(most), low = splat(-most);
  v = v < low ? low : v;
  return v > high ? high : v;
}

/// The nearest integers, those half-way away from zero. They fit two bytes.
inline void store_rounded(Lanes v, std::int16_t* at) {
  typedef std::int16_t Shorts __attribute__((vector_size(8)));
  typedef std::int32_t Integers __attribute__((vector_size(16)));
  const Lanes half = splat(0.5f);
  const auto shorts =
      __builtin_convertvector(__builtin_convertvector(v < splat(0) ? v - half : v + half, Integers), Shorts);
  std::memcpy(at, &shorts, sizeof shorts);
}

#else
#define PLIANT_HAS_VECTORS 0
constexpr bool kHasVectors = false;

// Inlined even where size counts: a call would pass all lanes through memory.
#define PLIANT_INLINE __attribute__((always_inline)) inline

struct Lanes {
  float a, b, c, d;
};

PLIANT_INLINE Lanes load(const float* at) {
  return {at[0], at[1], at[2], at[3]};
}
PLIANT_INLINE void store(const Lanes& v, float* at) {
  at[0] = v.a;
  at[1] = v.b;
  at[2] = v.c;
  at[3] = v.d;
}
PLIANT_INLINE Lanes splat(float x) {
  return {x, x, x, x};
}
PLIANT_INLINE float sum(const Lanes& v) {
  return (v.a + v.b) + (v.c + v.d);
}
PLIANT_INLINE Lanes operator+(const Lanes& v, const Lanes& w) {
  return {v.a + w.a, v.b + w.b, v.c + w.c, v.d + w.d};
}
PLIANT_INLINE Lanes operator-(const Lanes& v, const Lanes& w) {
  return {v.a - w.a, v.b - w.b, v.c - w.c, v.d - w.d};
}
PLIANT_INLINE Lanes operator*(const Lanes& v, const Lanes& w) {
  return {v.a * w.a, v.b * w.b, v.c * w.c, v.d * w.d};
}
PLIANT_INLINE void operator+=(Lanes& v, const Lanes& w) {
  v = v + w;
}
PLIANT_INLINE void operator-=(Lanes& v, const Lanes& w) {
  v = v - w;
}

#undef PLIANT_INLINE

#endif

}  // namespace pliant
