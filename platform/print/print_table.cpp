#include "print/print_table.hpp"

#include "model/table_check.hpp"

namespace pliant {

namespace {

static_assert(sizeof(PrintHeader) == 24 && sizeof(PrintKeypoint) == 40 && sizeof(Quat) == 16,
              "no padding in the table");

/// Largest scale and extent that a table may hold: those of a model's numbers.
constexpr float kLeastNumber = 1e-6f, kLargestNumber = 4e6f;

bool is_positive(float x) {
  return x >= kLeastNumber && x <= kLargestNumber;
}

bool is_unit(const Quat& q) {
  const float square = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
  return square > 0.999f && square < 1.001f;
}

bool is_valid(const PrintHeader& h) {
  return h.keypoint_count >= 1 && h.keypoint_count <= kMostKeypoints && h.view_count >= 1 &&
         h.view_count <= kMostPrintViews && h.level_count >= 1 && h.level_count <= kMostPrintLevels &&
         h.reserved == 0 && is_positive(h.extent_mm);
}

}  // namespace

Status PrintTable::open(Span<const std::uint8_t> bytes, PrintTable* table) {
  const Status status = check_table(bytes, {kPrintMagic, 0, sizeof(PrintHeader)});
  if (status != Status::ok) return status;
  const auto* const header = reinterpret_cast<const PrintHeader*>(bytes.data);
  const std::size_t views = sizeof(Quat) * header->view_count, levels = sizeof(float) * header->level_count,
                    keypoints = sizeof(PrintKeypoint) * header->keypoint_count;
  if (header->total_bytes != sizeof(PrintHeader) + views + levels + keypoints) return Status::bad_table;
  if (!is_valid(*header)) return Status::bad_table;
  PrintTable t;
  t.header_ = header;
  const std::uint8_t* const first = bytes.data + sizeof(PrintHeader);
  t.views_ = {reinterpret_cast<const Quat*>(first), header->view_count};
  t.levels_ = {reinterpret_cast<const float*>(first + views), header->level_count};
  t.keypoints_ = {reinterpret_cast<const PrintKeypoint*>(first + views + levels), header->keypoint_count};
  for (const Quat& q : t.views_)
    if (!is_unit(q)) return Status::bad_table;
  for (const float scale : t.levels_)
    if (!is_positive(scale)) return Status::bad_table;
  for (const PrintKeypoint& k : t.keypoints_)
    if (k.view >= header->view_count || k.level >= header->level_count) return Status::bad_table;
  *table = t;
  return Status::ok;
}

}  // namespace pliant
