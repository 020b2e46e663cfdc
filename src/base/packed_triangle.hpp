#pragma once
// A lower triangle of a square matrix, packed by rows: the place of an entry, and the number of entries.
#include <cstddef>

namespace pliant {

/// \pre column <= row.
constexpr std::size_t packed(std::size_t row, std::size_t column) {
  return row * (row + 1) / 2 + column;
}
constexpr std::size_t packed_size(std::size_t rows) {
  return rows * (rows + 1) / 2;
}

}  // namespace pliant
