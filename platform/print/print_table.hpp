#pragma once
// The keypoints of a surface's print: corners of its albedo with binary descriptors (docs/algorithms.md, section 7.17).
// Little-endian, read in place, from flash.
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/geometry.hpp"
#include "pliant/status.hpp"

namespace pliant {

constexpr int kDescriptorWords = 8;  ///< of 32 bits

/// A corner of the print as it looks from one direction at one scale.
struct PrintKeypoint {
  std::uint16_t u, v;        ///< in 1/65535
  std::int8_t cosine, sine;  ///< of its direction in the picture, in 1/127
  std::uint8_t view, level;  ///< indices of the table's views and levels
  std::uint32_t bits[kDescriptorWords];

  Vec2 uv() const { return {static_cast<float>(u) * (1.0f / 65535), static_cast<float>(v) * (1.0f / 65535)}; }
};

/// First bytes of a table. The views (Quat), levels (float) and keypoints follow it.
struct PrintHeader {
  std::uint32_t magic;        ///< kPrintMagic
  std::uint32_t total_bytes;  ///< of the table
  std::uint32_t crc32;        ///< IEEE CRC-32 of everything behind this field
  std::uint16_t keypoint_count, view_count, level_count;
  std::uint16_t reserved;  ///< 0
  float extent_mm;         ///< diagonal of the surface's bounding box at rest
};

constexpr std::uint32_t kPrintMagic = 0x31504c50;  ///< "PLP1"
constexpr std::size_t kMostKeypoints = 4096, kMostPrintViews = 64, kMostPrintLevels = 16;

/// A checked view of a table, which must outlive it.
class PrintTable {
 public:
  /// Checks all of it. \return `not_found` (no bytes), `misaligned` (not a multiple of 4), `truncated`, `bad_magic`,
  ///   `bad_checksum`, `bad_table`; `table` is then as before.
  static Status open(Span<const std::uint8_t> bytes, PrintTable* table);

  bool is_open() const { return header_ != nullptr; }
  float extent_mm() const { return header_->extent_mm; }
  /// Rotations of the views from which the print was seen, as in View::q. The first sees most of the surface
  /// from the front.
  Span<const Quat> views() const { return views_; }
  /// Scales at which it was seen, px/mm.
  Span<const float> levels() const { return levels_; }
  Span<const PrintKeypoint> keypoints() const { return keypoints_; }

 private:
  const PrintHeader* header_ = nullptr;
  Span<const Quat> views_;
  Span<const float> levels_;
  Span<const PrintKeypoint> keypoints_;
};

}  // namespace pliant
