#pragma once
/// \file weight_table.hpp
/// The bytes of a table of learnt weights: numbers in the order in which they are read, rows of weights as int8.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pliant::host::learn {

/// Rows of int8, each with its largest weight at 127.
struct QuantisedRows {
  std::vector<double> scale;  ///< of each row: weight = scale * byte
  std::vector<std::int8_t> bytes;

  QuantisedRows(const std::vector<double>& weights, std::size_t columns);
};

/// Information matrices, xx, xy, yy each, whose off-diagonal entries shrink a little, so that rounding cannot make one
/// indefinite.
std::vector<double> safe_information(std::vector<double> information);

/// A table that grows at its end.
class WeightTable {
 public:
  template <class T>
  void put(const T& value) {
    const auto* const first = reinterpret_cast<const std::uint8_t*>(&value);
    bytes_.insert(bytes_.end(), first, first + sizeof(T));
  }
  void put_floats(const std::vector<double>& values);
  void put_bytes(const std::vector<std::int8_t>& values);
  /// Zeros up to a multiple of four bytes.
  void pad() { bytes_.resize((bytes_.size() + 3) / 4 * 4); }
  /// Writes a value over what is there.
  template <class T>
  void replace(std::size_t at, const T& value) {
    const auto* const first = reinterpret_cast<const std::uint8_t*>(&value);
    std::copy(first, first + sizeof(T), bytes_.begin() + static_cast<std::ptrdiff_t>(at));
  }
  std::size_t size() const { return bytes_.size(); }
  std::vector<std::uint8_t>& bytes() { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

}  // namespace pliant::host::learn
