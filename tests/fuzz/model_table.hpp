#pragma once
// Model tables for fuzzers: a small one, which is made here, and changes of a table that keep its checksum right.
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "host/io/aligned_table.hpp"
#include "pliant/model.hpp"
#include "textured_model.hpp"

namespace fuzz {

/// A table whose bytes may be changed.
class Table : public pliant::host::AlignedTable {
 public:
  using AlignedTable::AlignedTable;
  /// Makes the checksum right: it covers what follows its own place in the header.
  void seal() {
    constexpr std::size_t kAt = 12;
    if (size() < kAt + 4) return;
    const std::uint32_t crc = pliant::crc32(bytes() + kAt + 4, size() - kAt - 4);
    std::memcpy(bytes() + kAt, &crc, sizeof crc);
  }
};

inline std::vector<std::uint8_t> small_table() {
  TexturedModel model;
  model.albedo_side = 96;
  return model.bytes();
}

inline const pliant::Model& small_model() {
  static const Table table(small_table());
  static pliant::Model model;
  if (model.parameters().count == 0 &&
      pliant::Model::open(table.data(), table.size(), &model) != pliant::Status::ok)
    std::abort();
  return model;
}

}  // namespace fuzz
