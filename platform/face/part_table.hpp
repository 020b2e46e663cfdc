#pragma once
// The learnt table of part readers (docs/model-format.md). One little-endian block, read in place. `open`
// checks every size, index and number once; whatever opens is safe to use.
//
// Layout: PartHeader, PartRecords, then the weights that the records refer to.
#include <cstddef>
#include <cstdint>

#include "face/gradient_map.hpp"
#include "pliant/arena.hpp"
#include "pliant/geometry.hpp"
#include "pliant/status.hpp"

namespace pliant {

constexpr std::uint32_t kPartMagic = 0x31545250, kPartVersion = 1;  // "PRT1"
constexpr std::size_t kMostParts = 4, kMostPartPoints = 24, kMostPartStages = 4;
constexpr int kMostPartCropPx = 56;           // a side of a part's crop
constexpr std::size_t kMostPartBytes = 4096;  // of all blocks of a stage
constexpr int kPupilRight = 68, kPupilLeft = 69;

/// First bytes of the table.
struct PartHeader {
  std::uint32_t magic, version, total_bytes;
  std::uint32_t crc32;  // of everything behind this field
  std::uint16_t part_count, reserved;
};

/// A part of the face: where its crop is, and which points are read.
struct PartRecord {
  float mm_per_px;         // of the crop: the face's millimetres a pixel
  float below_mm;          // the crop's middle below the middle of the anchors, mm
  std::uint16_t crop_px;   // a side of the crop
  std::uint8_t is_paired;  // 1: the part of the left side is read in the mirrored crop
  std::uint8_t stage_count, point_count;
  std::uint8_t anchor[2];  // numbers of two landmarks, of the right side
  std::uint8_t reserved;
  struct Blocks {
    std::uint8_t cells;    // a side of the block around each point
    std::uint8_t cell_px;  // a side of a cell
  } stage[kMostPartStages];
  std::uint8_t number[kMostPartPoints];  // of the points: NN of ibugNN, 68 or 69 the right and left pupil
  std::uint32_t first_byte;              // of its weights
};

/// A stage moves every point to the middle of its block plus scale * (row . bytes of all blocks) + bias, mm.
struct PartStage {
  const float *scale, *bias;  // two a point: x, y
  const std::int8_t* rows;    // two a point
};

/// Where the points are at first, from the crop's middle, mm, two a point; and the information of the last
/// stage's positions, three a point: xx, xy, yy, 1/mm^2.
struct PartShape {
  const float *start, *information;
};

/// Bytes of one block, and of all blocks of a stage.
constexpr std::size_t part_block_bytes(PartRecord::Blocks b) {
  return static_cast<std::size_t>(b.cells) * b.cells * kBlockChannels;
}
constexpr std::size_t part_bytes(const PartRecord& p, std::size_t stage) {
  return p.point_count * part_block_bytes(p.stage[stage]);
}
/// Whether sizes and numbers are in range. The offset of the weights is not checked.
bool is_valid(const PartRecord& part);
/// Bytes of a part's weights, padded to 4.
std::size_t part_weight_bytes(const PartRecord& part);
/// Number of the same point of the other side.
int mirrored_part_point(int number);

/// A checked table.
class PartTable {
 public:
  /// \return not_found (no bytes), misaligned, truncated, bad_magic, bad_version, bad_checksum, bad_table;
  ///         `table` is then as before.
  static Status open(Span<const std::uint8_t> bytes, PartTable* table);

  std::size_t count() const { return parts_.count; }
  const PartRecord& operator[](std::size_t part) const { return parts_[part]; }
  PartShape shape(std::size_t part) const;
  PartStage stage(std::size_t part, std::size_t stage) const;

 private:
  const std::uint8_t* bytes_ = nullptr;
  Span<const PartRecord> parts_;
};

}  // namespace pliant
