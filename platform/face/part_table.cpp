#include "face/part_table.hpp"

#include "face/aligner_table.hpp"
#include "model/table_check.hpp"

namespace pliant {

namespace {

static_assert(sizeof(PartHeader) == 20 && sizeof(PartRecord) == 52);

bool are_valid(const PartShape& shape, std::size_t points) {
  for (std::size_t k = 0; k < points; ++k) {
    const float* const w = shape.information + 3 * k;
    if (!(w[1] * w[1] < w[0] * w[2])) return false;  // every point is read with a finite variance
  }
  return are_information(shape.information, points) && are_within(shape.start, 2 * points, -1e3f, 1e3f);
}

bool are_valid(const PartTable& table, std::size_t part) {
  const PartRecord& p = table[part];
  const std::size_t rows = 2u * p.point_count;
  for (std::size_t k = 0; k < p.stage_count; ++k) {
    const PartStage stage = table.stage(part, k);
    if (!are_within(stage.scale, rows, 0, 1e3f) || !are_within(stage.bias, rows, -1e3f, 1e3f)) return false;
  }
  return are_valid(table.shape(part), p.point_count);
}

/// Whether no point comes twice.
bool are_numbers(const PartRecord& p) {
  for (int k = 0; k < p.point_count; ++k) {
    if (p.number[k] > kPupilLeft) return false;
    for (int other = 0; other < k; ++other)
      if (p.number[other] == p.number[k]) return false;
  }
  return p.anchor[0] < kMostAlignerLandmarks && p.anchor[1] < kMostAlignerLandmarks;
}

}  // namespace

int mirrored_part_point(int number) {
  return number >= kPupilRight ? kPupilRight + kPupilLeft - number : mirrored_landmark_number(number);
}

bool is_valid(const PartRecord& p) {
  if (!(p.mm_per_px >= 0.2f && p.mm_per_px <= 8) || !(p.below_mm >= -200 && p.below_mm <= 200)) return false;
  if (p.crop_px > kMostPartCropPx || p.is_paired > 1 || p.stage_count < 1 ||
      p.stage_count > kMostPartStages || p.point_count < 1 || p.point_count > kMostPartPoints ||
      !are_numbers(p))
    return false;
  for (std::size_t k = 0; k < p.stage_count; ++k) {
    const PartRecord::Blocks b = p.stage[k];
    if (b.cells < 1 || b.cells > kMostBlockCells || b.cell_px < 1 || b.cell_px > kMostBlockCellPx ||
        b.cells * b.cell_px > p.crop_px || part_bytes(p, k) > kMostPartBytes)
      return false;
  }
  return true;
}

std::size_t part_weight_bytes(const PartRecord& p) {
  std::size_t rows = 0;
  for (std::size_t k = 0; k < p.stage_count; ++k) rows += 2 * p.point_count * part_bytes(p, k);
  return p.point_count * (5u + 4u * p.stage_count) * sizeof(float) + padded(rows);
}

Status PartTable::open(Span<const std::uint8_t> bytes, PartTable* table) {
  const Status status = check_table(bytes, {kPartMagic, kPartVersion, sizeof(PartHeader)});
  if (status != Status::ok) return status;
  const auto& header = *reinterpret_cast<const PartHeader*>(bytes.data);
  const std::size_t total = header.total_bytes, parts = header.part_count;
  if (parts < 1 || parts > kMostParts || total < sizeof(PartHeader) + parts * sizeof(PartRecord))
    return Status::bad_table;
  PartTable out;
  out.bytes_ = bytes.data;
  out.parts_ = {reinterpret_cast<const PartRecord*>(bytes.data + sizeof(PartHeader)), parts};
  for (std::size_t k = 0; k < parts; ++k) {
    const PartRecord& p = out.parts_[k];
    if (!is_valid(p) || !fits(p.first_byte, part_weight_bytes(p), total) || !are_valid(out, k))
      return Status::bad_table;
  }
  *table = out;
  return Status::ok;
}

PartShape PartTable::shape(std::size_t part) const {
  const auto* const numbers = reinterpret_cast<const float*>(bytes_ + parts_[part].first_byte);
  return {numbers, numbers + 2 * parts_[part].point_count};
}

PartStage PartTable::stage(std::size_t part, std::size_t stage) const {
  const PartRecord& p = parts_[part];
  const std::size_t points = p.point_count;
  const auto* const numbers = reinterpret_cast<const float*>(bytes_ + p.first_byte) + 5 * points;
  const auto* rows = reinterpret_cast<const std::int8_t*>(numbers + 4 * points * p.stage_count);
  for (std::size_t k = 0; k < stage; ++k) rows += 2 * points * part_bytes(p, k);
  return {numbers + 4 * points * stage, numbers + 4 * points * stage + 2 * points, rows};
}

}  // namespace pliant
