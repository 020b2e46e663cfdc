#pragma once
// Reads and checks a model table (docs/model-format.md).
#include "pliant/model.hpp"

namespace pliant {

namespace table {
/// Most parameters, landmarks and records of a table. Such counts bound the memory and time of every object that a model gives its
/// size to.
constexpr std::size_t kMaxParameters = 192, kMaxLandmarks = 4096, kMaxRecords = 320;
}  // namespace table

/// Fills `contents` with pointers into the table at `data`.
/// \pre `data` is a multiple of four.
/// \return truncated, bad_magic, bad_version, bad_checksum, bad_table; `contents` is then as before.
Status read_table(const void* data, std::size_t bytes, table::Contents* contents);

/// Whether two names of a table are the same.
bool same_name(const char* a, const char* b);

}  // namespace pliant
