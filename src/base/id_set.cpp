#include "pliant/id_set.hpp"

namespace pliant {
namespace {

std::size_t words_for(std::size_t bits) {
  return (bits + 63) / 64;
}

}  // namespace

void IdSet::lay_out(Arena& arena, std::size_t capacity) {
  capacity_ = capacity;
  used_ = capacity;
  free_ = arena.take<std::uint64_t>(words_for(capacity));
  groups_ = arena.take<std::uint64_t>(words_for(words_for(capacity)));
}

void IdSet::reset(std::size_t used) {
  const std::size_t words = words_for(capacity_), groups = words_for(words);
  for (std::size_t w = 0; w < words; ++w) {
    std::uint64_t bits = 0;
    for (std::size_t b = 0; b < 64; ++b) {
      const std::size_t id = w * 64 + b;
      if (id >= used && id < capacity_) bits |= std::uint64_t{1} << b;
    }
    free_[w] = bits;
  }
  for (std::size_t g = 0; g < groups; ++g) {
    std::uint64_t bits = 0;
    for (std::size_t b = 0; b < 64 && g * 64 + b < words; ++b)
      if (free_[g * 64 + b] != 0) bits |= std::uint64_t{1} << b;
    groups_[g] = bits;
  }
  used_ = used;
  lowest_ = used / 64;
}

// Finds the first word with a free id, after the last id of word `emptied` was taken. No earlier word has one.
void IdSet::find_lowest(std::size_t emptied) {
  const std::size_t groups = words_for(words_for(capacity_));
  std::size_t group = emptied >> 6;
  groups_[group] &= ~(std::uint64_t{1} << (emptied & 63));
  while (group < groups && groups_[group] == 0) ++group;
  lowest_ = group < groups ? group << 6 | lowest_bit(groups_[group]) : words_for(capacity_);
}

void IdSet::copy_from(const IdSet& other) {
  for (std::size_t w = 0; w < words_for(capacity_); ++w) free_[w] = other.free_[w];
  for (std::size_t g = 0; g < words_for(words_for(capacity_)); ++g) groups_[g] = other.groups_[g];
  used_ = other.used_;
  lowest_ = other.lowest_;
}

}  // namespace pliant
