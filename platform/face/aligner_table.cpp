#include "face/aligner_table.hpp"

#include "model/table_check.hpp"

namespace pliant {

// Ranges within which the numbers run backwards.
int mirrored_landmark_number(int number) {
  constexpr struct {
    int last, sum;
  } kRanges[] = {{16, 16}, {26, 43}, {30, 0},   {35, 66},  {39, 81},  {41, 87},
                 {45, 81}, {47, 87}, {54, 102}, {59, 114}, {64, 124}, {67, 132}};
  for (const auto& range : kRanges)
    if (number <= range.last) return range.sum == 0 ? number : range.sum - number;
  return number;
}

int part_of_landmark(int number) {
  const auto is_in = [number](int first, int last) { return number >= first && number <= last; };
  if (!is_in(17, 47)) return 3;
  if (is_in(27, 35)) return 2;
  return is_in(22, 26) || number >= 42 ? 1 : 0;
}

namespace {

static_assert(sizeof(AlignerHeader) == 20 && sizeof(AlignerStage) == 20 && sizeof(AlignerCurve) == 88);

bool is_valid(const AlignerCurve& c) {
  return are_within(c.weight, kCheckFeatures, -1e6f, 1e6f) && are_within(c.at, kCheckKnots, 0, 1) &&
         c.low >= -1e6f && c.high <= 1e6f && c.high > c.low;
}

bool are_ascending(const std::uint8_t* numbers, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k)
    if (numbers[k] >= kMostAlignerLandmarks || (k > 0 && numbers[k] <= numbers[k - 1])) return false;
  return true;
}

/// \return false if a landmark is without its counterpart.
bool find_mirrored(const std::uint8_t* numbers, std::size_t count, std::uint8_t* mirrored) {
  for (std::size_t k = 0; k < count; ++k) {
    std::size_t other = 0;
    while (other < count && numbers[other] != mirrored_landmark_number(numbers[k])) ++other;
    if (other == count) return false;
    mirrored[k] = static_cast<std::uint8_t>(other);
  }
  return true;
}

template <class T>
const T* take(const std::uint8_t*& at, std::size_t count) {
  const std::uint8_t* const first = at;
  at += padded(count * sizeof(T));
  return reinterpret_cast<const T*>(first);
}

bool is_valid(const LocalWeights& w, std::size_t landmarks) {
  return are_within(w.scale, 2 * landmarks, 0, 1e3f) && are_within(w.bias, 2 * landmarks, -1e3f, 1e3f) &&
         are_information(w.information, landmarks) && are_within(w.blend, landmarks, 0, 1);
}

bool is_valid(const GlobalWeights& w, std::size_t components, std::size_t landmarks) {
  return are_within(w.scale, components, 0, 1e3f) && are_within(w.bias, components, -1e3f, 1e3f) &&
         are_within(w.mean, 2 * landmarks, -1e3f, 1e3f) && are_information(w.information, landmarks);
}

}  // namespace

bool is_valid(const AlignerStage& s) {
  if (!(s.mm_per_px >= 0.5f && s.mm_per_px <= 8) || !(s.prior >= 0 && s.prior <= 1e6f)) return false;
  if (s.cells < 1 || s.cells > kMostBlockCells || s.cell_px < 1 || s.cell_px > kMostBlockCellPx) return false;
  if (s.crop_px < s.cells * s.cell_px || s.crop_px > kMostCropPx) return false;
  if (s.components > kMostAlignerComponents || s.refines > 1 || s.stride < 1) return false;
  return s.components == 0
             ? s.blocks == 0
             : s.blocks >= 1 && s.blocks <= kMostBlocks && s.blocks * s.cells * s.cell_px <= s.crop_px;
}

std::size_t weight_bytes(const AlignerStage& stage, std::size_t landmarks) {
  const std::size_t components = stage.components, block = block_bytes(stage);
  if (components == 0) return landmarks * (2 + 2 + 3 + 1) * sizeof(float) + padded(2 * landmarks * block);
  const std::size_t blocks = static_cast<std::size_t>(stage.blocks) * stage.blocks;
  return (2 * components + (2 + 3) * landmarks) * sizeof(float) + padded(2 * landmarks * components) +
         padded(components * blocks * block);
}

std::size_t check_weight_bytes(const AlignerStage& last, std::size_t landmarks) {
  return 2 * landmarks * sizeof(float) + padded(landmarks * block_bytes(last));
}

std::size_t landmark_room(Span<const std::uint8_t> table) {
  constexpr std::size_t kAt = offsetof(AlignerHeader, landmark_count);  // the lower byte: no good table has more
  const std::size_t count = table.count > kAt ? table.data[kAt] : kMostAlignerLandmarks;
  return count < kMostAlignerLandmarks ? count : kMostAlignerLandmarks;
}

Status AlignerTable::open(Span<const std::uint8_t> bytes, AlignerTable* table, bool is_summed) {
  const Status status =
      check_table(bytes, {kAlignerMagic, kAlignerVersion, sizeof(AlignerHeader)}, is_summed);
  if (status != Status::ok) return status;
  const auto& header = *reinterpret_cast<const AlignerHeader*>(bytes.data);
  const std::size_t landmarks = header.landmark_count, stages = header.stage_count,
                    total = header.total_bytes;
  if (landmarks < 4 || landmarks > kMostAlignerLandmarks || stages < 1 || stages > kMostAlignerStages)
    return Status::bad_table;
  const std::size_t stages_at = sizeof(AlignerHeader) + padded(landmarks);
  const std::size_t check_at = stages_at + stages * sizeof(AlignerStage);
  if (check_at + sizeof(AlignerCheck) > total) return Status::bad_table;
  AlignerTable out;
  out.bytes_ = bytes.data;
  out.landmarks_ = landmarks;
  out.numbers_ = bytes.data + sizeof(AlignerHeader);
  out.stages_ = {reinterpret_cast<const AlignerStage*>(bytes.data + stages_at), stages};
  out.check_ = reinterpret_cast<const AlignerCheck*>(bytes.data + check_at);
  if (!are_ascending(out.numbers_, landmarks) || !find_mirrored(out.numbers_, landmarks, out.mirrored_))
    return Status::bad_table;
  for (std::size_t k = 0; k < stages; ++k) {
    const AlignerStage& s = out.stages_[k];
    if (!is_valid(s) || !fits(s.first_byte, weight_bytes(s, landmarks), total)) return Status::bad_table;
    if (s.components == 0 ? !is_valid(out.local(k), landmarks)
                          : !is_valid(out.global(k), s.components, landmarks))
      return Status::bad_table;
  }
  const AlignerStage& last = out.stages_[stages - 1];
  const auto are_valid = [&](std::uint32_t first_byte) {  // scales, then biases
    return fits(first_byte, check_weight_bytes(last, landmarks), total) &&
           are_within(out.check_weights(first_byte).scale, 2 * landmarks, -1e3f, 1e3f);
  };
  if (last.components != 0 || !is_valid(out.check_->score) || !is_valid(out.check_->error) ||
      !are_within(out.check_->usual, 2 * kFaceParts, -1e3f, 1e3f) || !are_valid(out.check_->first_byte) ||
      (out.tells_text() && !are_valid(out.check_->text_byte)))
    return Status::bad_table;
  *table = out;
  return Status::ok;
}

LocalWeights AlignerTable::local(std::size_t stage) const {
  const std::uint8_t* at = bytes_ + stages_[stage].first_byte;
  LocalWeights w;
  w.scale = take<float>(at, 2 * landmarks_);
  w.bias = take<float>(at, 2 * landmarks_);
  w.information = take<float>(at, 3 * landmarks_);
  w.blend = take<float>(at, landmarks_);
  w.rows = take<std::int8_t>(at, 2 * landmarks_ * block_bytes(stages_[stage]));
  return w;
}

GlobalWeights AlignerTable::global(std::size_t stage) const {
  const AlignerStage& s = stages_[stage];
  const std::uint8_t* at = bytes_ + s.first_byte;
  GlobalWeights w;
  w.scale = take<float>(at, s.components);
  w.bias = take<float>(at, s.components);
  w.mean = take<float>(at, 2 * landmarks_);
  w.information = take<float>(at, 3 * landmarks_);
  w.output = take<std::int8_t>(at, 2 * landmarks_ * s.components);
  w.basis =
      take<std::int8_t>(at, s.components * static_cast<std::size_t>(s.blocks) * s.blocks * block_bytes(s));
  return w;
}

CheckWeights AlignerTable::check_weights(std::uint32_t first_byte) const {
  const std::uint8_t* at = bytes_ + first_byte;
  CheckWeights w;
  w.scale = take<float>(at, landmarks_);
  w.bias = take<float>(at, landmarks_);
  w.rows = take<std::int8_t>(at, landmarks_ * block_bytes(stages_[stages_.count - 1]));
  return w;
}

}  // namespace pliant
