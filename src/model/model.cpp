#include "pliant/model.hpp"

#include "model/table_check.hpp"
#include "model/table_reader.hpp"

namespace pliant {

std::uint32_t crc32(const void* data, std::size_t bytes, std::uint32_t previous) {
  // Half a byte at a time: the remainders take 64 bytes instead of 1 KiB, and a table is read once.
  std::uint32_t nibble[16];
  for (std::uint32_t i = 0; i < 16; ++i) {
    std::uint32_t c = i;
    for (int k = 0; k < 4; ++k) c = (c & 1u) ? 0xedb88320u ^ (c >> 1) : c >> 1;
    nibble[i] = c;
  }
  const auto* p = static_cast<const std::uint8_t*>(data);
  std::uint32_t c = ~previous;
  for (std::size_t i = 0; i < bytes; ++i) {
    c ^= p[i];
    c = nibble[c & 15u] ^ (c >> 4);
    c = nibble[c & 15u] ^ (c >> 4);
  }
  return ~c;
}

Status Model::open(const void* data, std::size_t bytes, Model* model) {
  if (data == nullptr || model == nullptr) return Status::bad_argument;
  if (reinterpret_cast<std::uintptr_t>(data) % 4 != 0) return Status::misaligned;
  return read_table(data, bytes, &model->contents_);
}

std::uint16_t Model::find_parameter(const char* name) const {
  PLIANT_ASSERT(name != nullptr);
  for (std::size_t i = 0; i < parameters().count; ++i)
    if (same_name(parameters()[i].name, name)) return static_cast<std::uint16_t>(i);
  return kNone;
}

std::uint16_t Model::find_landmark(const char* name) const {
  PLIANT_ASSERT(name != nullptr);
  for (std::size_t i = 0; i < landmarks().count; ++i)
    if (same_name(landmarks()[i].name, name)) return static_cast<std::uint16_t>(i);
  return kNone;
}

bool Model::is_on_surface(Vec2 uv) const {
  if (!is_open() || !are_within(&uv.x, 2, 0, 1)) return false;
  const auto i = static_cast<std::size_t>(uv.x * static_cast<float>(contents_.mask.width - 1) + 0.5f);
  const auto j = static_cast<std::size_t>(uv.y * static_cast<float>(contents_.mask.height - 1) + 0.5f);
  return contents_.mask.pixels[j * contents_.mask.width + i] != 0;
}

}  // namespace pliant
