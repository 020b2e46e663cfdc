#include "host/io/learnt_file.hpp"

#include <algorithm>
#include <cstring>

#include "host/io/failure.hpp"
#include "host/io/files.hpp"
#include "pliant/model.hpp"

namespace pliant::host {

namespace {

struct LearntHeader {
  std::uint32_t magic, version;  // kMagic and kVersion
  std::uint32_t crc32;           // of everything behind this field
  std::uint32_t detector_bytes, aligner_bytes, parts_bytes;
};
static_assert(sizeof(LearntHeader) == 24, "file format");

constexpr std::uint32_t kMagic = 0x314e524c, kVersion = 2;  // "LRN1"
constexpr std::size_t kUncheckedBytes = 12;                 // of the header, before what the checksum covers
constexpr std::size_t kMaxFileBytes = std::size_t{1} << 22;

std::uint32_t checksum(const std::string& file) {
  return crc32(file.data() + kUncheckedBytes, file.size() - kUncheckedBytes);
}

}  // namespace

std::string format_learnt(const LearntTables& tables) {
  LearntHeader h{kMagic, kVersion, 0, static_cast<std::uint32_t>(tables.detector.size()),
                 static_cast<std::uint32_t>(tables.aligner.size()),
                 static_cast<std::uint32_t>(tables.parts.size())};
  std::string file(sizeof h, '\0');
  file.append(tables.detector.begin(), tables.detector.end());
  file.append(tables.aligner.begin(), tables.aligner.end());
  file.append(tables.parts.begin(), tables.parts.end());
  std::memcpy(file.data(), &h, sizeof h);
  h.crc32 = checksum(file);
  std::memcpy(file.data(), &h, sizeof h);
  return file;
}

LearntTables read_learnt(const std::string& path) {
  const std::string file = read_file(path, kMaxFileBytes);
  LearntHeader h{};
  if (file.size() >= sizeof h.magic) std::memcpy(&h, file.data(), std::min(file.size(), sizeof h));
  if (h.magic != kMagic) fail_input(path, "is no file of learnt tables");
  if (file.size() < sizeof h) fail_input(path, "is cut off");
  if (h.version != kVersion) fail_input(path, "is a file of learnt tables of another version");
  const std::uint64_t size = sizeof h + std::uint64_t{h.detector_bytes} + h.aligner_bytes + h.parts_bytes;
  if (file.size() < size) fail_input(path, "is cut off");
  if (file.size() > size) fail_input(path, "has bytes behind its end");
  if (checksum(file) != h.crc32) fail_input(path, "is damaged: its checksum is wrong");
  const auto* first = reinterpret_cast<const std::uint8_t*>(file.data()) + sizeof h;
  const auto* middle = first + h.detector_bytes;
  const auto* last = middle + h.aligner_bytes;
  return {{first, middle}, {middle, last}, {last, last + h.parts_bytes}};
}

}  // namespace pliant::host
