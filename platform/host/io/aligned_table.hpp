#pragma once
/// \file aligned_table.hpp
/// A table in memory of its own, aligned as the library requires it.
#include <algorithm>
#include <cstdint>
#include <vector>

#include "pliant/arena.hpp"

namespace pliant::host {

/// A copy of the bytes of a table. The library uses a table in place: this must live as long as what was opened from it.
class AlignedTable {
 public:
  explicit AlignedTable(const std::vector<std::uint8_t>& bytes)
      : words_((bytes.size() + 3) / 4), size_(bytes.size()) {
    std::copy(bytes.begin(), bytes.end(), this->bytes());
  }

  const void* data() const { return words_.data(); }
  std::size_t size() const { return size_; }
  std::uint8_t* bytes() { return reinterpret_cast<std::uint8_t*>(words_.data()); }
  Span<const std::uint8_t> span() const {
    return {reinterpret_cast<const std::uint8_t*>(words_.data()), size_};
  }

 private:
  std::vector<std::uint32_t> words_;
  std::size_t size_;
};

}  // namespace pliant::host
