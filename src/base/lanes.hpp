#pragma once
// Four floats at a time. GCC and Clang translate the vector type to what the target has, down to scalars, with the same
// results: only `sum` adds across lanes.
#include <cstddef>
#include <cstring>

namespace pliant {

typedef float Lanes __attribute__((vector_size(16)));
constexpr std::size_t kLanes = 4;

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

}  // namespace pliant
