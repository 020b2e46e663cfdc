#pragma once
// Checks that the model's table and the tables inside it need.
#include "pliant/arena.hpp"
#include "pliant/status.hpp"

namespace pliant {

/// What a table inside a model begins with: magic number, version where it has one, length and checksum.
struct TableForm {
  std::uint32_t magic, version;  ///< version 0: the table has none
  std::size_t header_bytes;      ///< of the whole header
};

/// \param is_summed  true: the checksum is known to be right.
/// \return not_found (no bytes), misaligned, truncated, bad_magic, bad_version, bad_table (the length), bad_checksum.
Status check_table(Span<const std::uint8_t> bytes, const TableForm& form, bool is_summed = false);

/// Bytes of an array in a table: the next one begins at a multiple of 4.
constexpr std::size_t padded(std::size_t bytes) {
  return (bytes + 3) / 4 * 4;
}
/// Whether `count` bytes from `first` on, which must be a multiple of 4, are in a table of `total` bytes.
constexpr bool fits(std::uint32_t first, std::size_t count, std::size_t total) {
  return first % 4 == 0 && first <= total && count <= total - first;
}

/// Whether all values are in [low, high]. False for NaN.
bool are_within(const float* x, std::size_t count, float low, float high);

/// Whether the information (xx, xy, yy each) of all points is that of a variance that may be infinite.
bool are_information(const float* w, std::size_t count);

}  // namespace pliant
