#include "model/table_check.hpp"

#include "pliant/model.hpp"

namespace pliant {

Status check_table(Span<const std::uint8_t> bytes, const TableForm& form, bool is_summed) {
  if (bytes.data == nullptr || bytes.count == 0) return Status::not_found;
  if (reinterpret_cast<std::uintptr_t>(bytes.data) % sizeof(std::uint32_t) != 0) return Status::misaligned;
  if (bytes.count < form.header_bytes) return Status::truncated;
  const auto* word = reinterpret_cast<const std::uint32_t*>(bytes.data);
  if (*word++ != form.magic) return Status::bad_magic;
  if (form.version != 0 && *word++ != form.version) return Status::bad_version;
  const std::size_t total = *word++;
  if (total > bytes.count) return Status::truncated;
  if (total < form.header_bytes) return Status::bad_table;
  const std::uint32_t sum = *word++;
  const auto* const first = reinterpret_cast<const std::uint8_t*>(word);
  const bool is_right =
      is_summed || crc32(first, total - static_cast<std::size_t>(first - bytes.data)) == sum;
  return is_right ? Status::ok : Status::bad_checksum;
}

bool are_within(const float* x, std::size_t count, float low, float high) {
  for (std::size_t k = 0; k < count; ++k)
    if (!(x[k] >= low && x[k] <= high)) return false;
  return true;
}

bool are_information(const float* w, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k, w += 3)
    if (!(w[0] >= 0 && w[2] >= 0 && w[0] <= 1e4f && w[2] <= 1e4f && w[1] * w[1] <= w[0] * w[2])) return false;
  return true;
}

}  // namespace pliant
