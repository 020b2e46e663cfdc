#include "pliant/model.hpp"

#include "model/table_check.hpp"
#include "model/table_reader.hpp"

namespace pliant {

std::uint32_t crc32(const void* data, std::size_t bytes, std::uint32_t previous) {
  // Four bytes at a time, as eight halves of a byte: remainder[n] are those of a half with n more behind it. They take 512 bytes
  // of stack instead of 4 KiB.
  std::uint32_t remainder[8][16];
  for (std::uint32_t i = 0; i < 16; ++i) {
    std::uint32_t c = i;
    for (int k = 0; k < 4; ++k) c = (c & 1u) ? 0xedb88320u ^ (c >> 1) : c >> 1;
    remainder[0][i] = c;
  }
  for (std::size_t n = 1; n < 8; ++n)
    for (std::size_t i = 0; i < 16; ++i) {
      const std::uint32_t c = remainder[n - 1][i];
      remainder[n][i] = remainder[0][c & 15u] ^ (c >> 4);
    }
  const auto* p = static_cast<const std::uint8_t*>(data);
  std::uint32_t c = ~previous;
  for (; bytes >= 4; bytes -= 4, p += 4) {
    c ^= p[0] | std::uint32_t{p[1]} << 8 | std::uint32_t{p[2]} << 16 | std::uint32_t{p[3]} << 24;
    std::uint32_t next = 0;
    for (std::size_t n = 0; n < 8; ++n, c >>= 4) next ^= remainder[7 - n][c & 15u];
    c = next;
  }
  for (; bytes > 0; --bytes, ++p) {
    c ^= *p;
    c = remainder[0][c & 15u] ^ (c >> 4);
    c = remainder[0][c & 15u] ^ (c >> 4);
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
