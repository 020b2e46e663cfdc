#pragma once
/// \file split_mix.hpp
/// Random numbers of benchmarks.
#include <cstdint>

namespace pliant::host {

/// The generator SplitMix64 (Steele, Lea and Flood 2014): the same numbers on every machine.
struct SplitMix {
  std::uint64_t state;

  /// In [0, 1).
  double uniform() {
    std::uint64_t z = (state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }
};

}  // namespace pliant::host
