// Selection by radix. Floats are compared as integers of the same order, so the k-th smallest is exact, takes a bounded
// number of passes, and does not depend on the order of the rows.
#include <cstring>

#include "optim/mcd_kernel.hpp"

namespace pliant::mcd {

namespace {

std::uint32_t key_of(float value) {  // ascending with value; -0 just below +0
  std::uint32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  const std::uint32_t sign = 0u - (bits >> 31);
  return bits ^ (sign | 0x80000000u);
}

float value_of(std::uint32_t key) {
  const std::uint32_t bits = key & 0x80000000u ? key ^ 0x80000000u : ~key;
  float value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

constexpr std::size_t kFew = kTuning.sorted_directly;

/// Keeps, in order, the keys that have the same digit (at `shift`, under `mask`) as the k-th smallest. k becomes its rank
/// among them.
std::size_t keep_digit(std::uint32_t* key, std::size_t n, std::size_t& k, unsigned shift, std::uint32_t mask,
                       std::uint16_t* histogram) {
  std::uint32_t low = mask, high = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t digit = (key[i] >> shift) & mask;
    ++histogram[digit];
    if (digit < low) low = digit;
    if (digit > high) high = digit;
  }
  std::uint32_t digit = low;
  for (; k > histogram[digit]; ++digit) k -= histogram[digit];
  for (std::uint32_t d = low; d <= high; ++d) histogram[d] = 0;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t value = key[i];
    key[kept] = value;
    kept += ((value >> shift) & mask) == digit;
  }
  return kept;
}

}  // namespace

float kth_smallest(const float* value, std::size_t n, std::size_t k, const Scratch& scratch) {
  std::uint32_t* key = scratch.key;
  for (std::size_t i = 0; i < n; ++i) key[i] = key_of(value[i]);
  if (n > kFew) n = keep_digit(key, n, k, 20, 0xfff, scratch.histogram);
  if (n > kFew) n = keep_digit(key, n, k, 10, 0x3ff, scratch.histogram);
  if (n > kFew) n = keep_digit(key, n, k, 0, 0x3ff, scratch.histogram);
  if (n > kFew) return value_of(key[0]);  // all equal
  for (std::size_t i = 1; i < n; ++i) {
    const std::uint32_t moved = key[i];
    std::size_t hole = i;
    for (; hole > 0 && key[hole - 1] > moved; --hole) key[hole] = key[hole - 1];
    key[hole] = moved;
  }
  return value_of(key[k - 1]);
}

void smallest_rows(const float* value, std::size_t n, std::size_t h, std::uint16_t* row,
                   const Scratch& scratch) {
  const float limit = kth_smallest(value, n, h, scratch);
  std::uint32_t below = 0;
  for (std::size_t i = 0; i < n; ++i) below += value[i] < limit ? 1u : 0u;
  std::size_t ties = h - below, count = 0;
  for (std::size_t i = 0; count < h; ++i) {
    const bool is_tie = value[i] == limit && ties > 0;
    row[count] = static_cast<std::uint16_t>(i);
    count += (value[i] < limit || is_tie) ? 1u : 0u;
    ties -= is_tie ? 1u : 0u;
  }
}

}  // namespace pliant::mcd
