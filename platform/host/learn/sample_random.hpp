#pragma once
/// \file sample_random.hpp
/// Random numbers, the same on every machine; for training samples a stream for each pair of seed and index.
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace pliant::host::learn {

/// The generator SplitMix64 (Steele, Lea and Flood 2014).
struct SplitMix {
  std::uint64_t state;

  static std::uint64_t mixed(std::uint64_t x) {
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
    x = (x ^ x >> 27) * 0x94d049bb133111ebu;
    return x ^ x >> 31;
  }
  std::uint64_t bits() { return mixed(state += 0x9e3779b97f4a7c15u); }
  /// In [0, 1).
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
};

/// Streams of different indices are independent, so that samples can be drawn in any order.
class SampleRandom {
 public:
  SampleRandom(std::uint64_t seed, std::uint64_t index)
      : generator_{SplitMix::mixed(seed) ^ SplitMix::mixed(~index)} {}

  std::uint64_t bits() { return generator_.bits(); }
  /// In [0, 1).
  float unit() { return static_cast<float>(bits() >> 40) * (1.0f / 16777216); }
  /// In [low, high).
  float between(float low, float high) { return low + (high - low) * unit(); }
  /// In [low, high), as many in each octave. \pre low > 0.
  float octaves_between(float low, float high) { return low * std::pow(high / low, unit()); }
  /// In 0 .. n-1. \pre n > 0.
  std::size_t below(std::size_t n) { return static_cast<std::size_t>((bits() >> 32) * n >> 32); }
  /// True with this probability.
  bool chance(float probability) { return unit() < probability; }
  /// Normal with mean 0 and standard deviation 1, to good approximation: the sum of four uniform numbers.
  float normal() {
    const std::uint64_t b = bits();
    const auto part = [&](int k) { return static_cast<float>(b >> 16 * k & 0xffffu); };
    return (part(0) + part(1) + part(2) + part(3) - 131070) * (1.7320508f / 65536);
  }

 private:
  SplitMix generator_;
};

}  // namespace pliant::host::learn
