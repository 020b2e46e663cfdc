#include "pliant/model.hpp"

#include "model/chart.hpp"
#include "model/table_reader.hpp"

namespace pliant {

std::uint32_t crc32(const void* data, std::size_t bytes, std::uint32_t previous) {
  // Remainders of the 16 upper halves of a byte, then of the 16 lower ones: 128 bytes of stack, where whole bytes take 1 KiB.
  std::uint32_t remainder[32];
  for (std::uint32_t i = 0; i < 32; ++i) {
    std::uint32_t c = i < 16 ? i : remainder[i - 16];
    for (int k = 0; k < 4; ++k) c = (c & 1u) ? 0xedb88320u ^ (c >> 1) : c >> 1;
    remainder[i] = c;
  }
  const auto* p = static_cast<const std::uint8_t*>(data);
  std::uint32_t c = ~previous;
  for (std::size_t i = 0; i < bytes; ++i) {
    c ^= p[i];
    c = remainder[16 + (c & 15u)] ^ remainder[c >> 4 & 15u] ^ (c >> 8);
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
  if (!is_open() || !is_in_chart(uv)) return false;
  const auto i = static_cast<std::size_t>(uv.x * static_cast<float>(contents_.mask.width - 1) + 0.5f);
  const auto j = static_cast<std::size_t>(uv.y * static_cast<float>(contents_.mask.height - 1) + 0.5f);
  return contents_.mask.pixels[j * contents_.mask.width + i] != 0;
}

}  // namespace pliant
