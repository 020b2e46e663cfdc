#pragma once
// The binomial [1 4 6 4 1], along one axis and then the other. Every sum fits 16 bits: loops of it become vectors.
#include <cstdint>

namespace pliant {

/// 16 times the mean of five pixels, or 256 times that of five such sums: at most 65,280.
constexpr int binomial_sum(int a, int b, int c, int d, int e) {
  return a + e + 2 * (c + 2 * (b + c + d));
}

/// The pixel of five such sums, rounded.
constexpr std::uint8_t binomial_mean(int a, int b, int c, int d, int e) {
  return static_cast<std::uint8_t>(static_cast<std::uint16_t>(binomial_sum(a, b, c, d, e) + 128) >> 8);
}

}  // namespace pliant
