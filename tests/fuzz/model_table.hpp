#pragma once
// Model tables for fuzzers: a small one, which is made here, and changes of a table that keep its checksum right.
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "pliant/model.hpp"
#include "textured_model.hpp"

namespace fuzz {

/// A table in aligned memory.
class Table {
 public:
  explicit Table(const std::vector<std::uint8_t>& bytes)
      : words_((bytes.size() + 3) / 4), size_(bytes.size()) {
    if (size_ > 0) std::memcpy(words_.data(), bytes.data(), size_);
  }
  std::uint8_t* bytes() { return reinterpret_cast<std::uint8_t*>(words_.data()); }
  std::size_t size() const { return size_; }
  const void* data() const { return words_.data(); }
  /// Makes the checksum right: it covers what follows its own place in the header.
  void seal() {
    constexpr std::size_t kAt = 12;
    if (size_ < kAt + 4) return;
    const std::uint32_t crc = pliant::crc32(bytes() + kAt + 4, size_ - kAt - 4);
    std::memcpy(bytes() + kAt, &crc, sizeof crc);
  }

 private:
  std::vector<std::uint32_t> words_;
  std::size_t size_;
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
