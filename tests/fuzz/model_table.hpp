#pragma once
// Model tables for fuzzers: a small one, which is made here, and changes of a table that keep its checksum right.
#include <algorithm>
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

/// Changes something in a table. \param front  bytes at its front in which most of the structure is.
/// \param record  eight bytes: kind, position (3), value (4).
inline void change(pliant::Span<std::uint8_t> table, std::size_t front, const std::uint8_t* record) {
  static constexpr float kFloats[] = {0, -0.0f, 1, -1, 1e-38f, 1e6f, -1e6f, 3e38f, -3e38f, 0.5f, 1e3f, 1e30f};
  const std::size_t range = record[0] / 16 % 2 == 0 ? front : table.count;
  const std::size_t place =
      std::size_t{record[1]} | std::size_t{record[2]} << 8 | std::size_t{record[3]} << 16;
  const std::size_t position = place % std::min(range, table.count - 4);
  const std::size_t word = position / 4 * 4;
  switch (record[0] % 5) {
    case 0:
      table.data[position] = record[4];
      break;
    case 1:
      std::memcpy(table.data + position / 2 * 2, record + 4, 2);
      break;
    case 2:
      std::memcpy(table.data + word, record + 4, 4);
      break;
    case 3:
      std::memcpy(table.data + word, &kFloats[record[4] % 12], 4);
      break;
    default: {
      float value;
      std::memcpy(&value, table.data + word, 4);
      value *= kFloats[record[4] % 12];
      std::memcpy(table.data + word, &value, 4);
    }
  }
}

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
