#pragma once
// Integers within bounds. geometry.hpp has the same for floats.
#include <cstddef>

namespace pliant {

constexpr int smaller(int a, int b) {
  return a < b ? a : b;
}
constexpr int larger(int a, int b) {
  return a > b ? a : b;
}
constexpr std::size_t smaller(std::size_t a, std::size_t b) {
  return a < b ? a : b;
}
constexpr std::size_t larger(std::size_t a, std::size_t b) {
  return a > b ? a : b;
}
/// x, or the nearer end of [low, high]; low is at most high.
constexpr int within(int x, int low, int high) {
  return smaller(larger(x, low), high);
}

}  // namespace pliant
