#pragma once
/// \file table_checksum.hpp
/// The checksum in the header of a table.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "pliant/model.hpp"

namespace pliant::host {

/// Writes it: of everything behind the header's field `crc32`.
template <class Header>
void set_checksum(std::vector<std::uint8_t>& table) {
  constexpr std::size_t at = offsetof(Header, crc32), first = at + sizeof(std::uint32_t);
  const std::uint32_t crc = crc32(table.data() + first, table.size() - first);
  std::memcpy(table.data() + at, &crc, sizeof crc);
}

}  // namespace pliant::host
