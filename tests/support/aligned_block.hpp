#pragma once
// Memory for objects in an arena. The heap of a 32-bit target aligns to 8 bytes only, and an arena needs 16. It is full of NaN,
// so that what reads a value before it is written shows.
#include <algorithm>
#include <cstddef>
#include <vector>

#include "pliant/arena.hpp"

class AlignedBlock {
 public:
  explicit AlignedBlock(std::size_t bytes = 0)
      : lines_((bytes + sizeof(Line) - 1) / sizeof(Line)), size_(bytes) {
    std::fill(data(), data() + lines_.size() * sizeof(Line), static_cast<unsigned char>(0xFF));
  }
  unsigned char* data() { return reinterpret_cast<unsigned char*>(lines_.data()); }
  std::size_t size() const { return size_; }
  std::vector<unsigned char> copy() { return std::vector<unsigned char>(data(), data() + size_); }

 private:
  struct alignas(pliant::Arena::kAlignment) Line {
    unsigned char bytes[pliant::Arena::kAlignment];
  };
  std::vector<Line> lines_;
  std::size_t size_;
};
