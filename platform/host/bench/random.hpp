#pragma once
/// \file random.hpp
/// A random generator (xorshift) with the same numbers on every machine.
#include <cstddef>
#include <cstdint>

namespace pliant::host {

struct BenchRandom {
  std::uint32_t state = 2463534242u;  ///< any number but 0

  std::uint32_t bits() {
    state ^= state << 13;
    state ^= state >> 17;
    state ^= state << 5;
    return state;
  }
  /// In [0, 1).
  float unit() { return static_cast<float>(bits() >> 8) * (1.0f / 16777216); }
  /// In 0 .. n-1.
  std::size_t below(std::size_t n) { return bits() % n; }
};

}  // namespace pliant::host
