#include "face/part_reader.hpp"

#include "base/integers.hpp"

namespace pliant {

namespace {

/// Tuning of the readers. Each constant: unit, reason, experiment.
struct PartReaderTuning {
  /// Places of a picture where noise is measured, at most, count: the median of the 200 to 500 that are left is known to 5 to 8 %.
  /// With 4096 a tracked frame of a Cortex-M7 took 3 % more instructions, with 512 0.8 %. Round value.
  int noise_places = 512;
};
constexpr PartReaderTuning kTuning{};

/// Side of the picture from which a crop is cut, px: the diagonal of the largest crop, and a border.
constexpr int kPictureSide = kMostPartCropPx * 3 / 2;

}  // namespace

CropMap upright(const View& view) {
  const Vec2 down = down_of(Projector(view, true));
  CropMap axes;
  axes.side = 1;
  axes.right = view.s * Vec2{down.y, -down.x};
  return axes;
}

CropMap crop_of_part(const PartRecord& part, const View& view, Vec2 middle) {
  CropMap map = upright(view);
  map.side = part.crop_px;
  map.origin = middle + map.along({0, part.below_mm});
  map.right = part.mm_per_px * map.right;
  return map;
}

void PartReader::lay_out(Arena& arena) {
  picture_.lay_out(arena, kPictureSide);
  gradients_.lay_out(arena, kMostPartCropPx);
  bytes_ = arena.take<std::uint8_t>(kMostPartBytes);
  mm_ = arena.take<Vec2>(kMostPartPoints);
}

void PartReader::prepare(const FrameView& frame, const CropMap& map, bool is_mirrored) {
  // No larger than the turned crop needs.
  const float across = (magnitude(map.right.x) + magnitude(map.right.y)) / max(1, length(map.right));
  const int needed = static_cast<int>(across * static_cast<float>(map.side + 2)) + 4;
  picture_.set_side(smaller(needed, kPictureSide));
  picture_.take(frame, map.origin, length(map.right), gradients_.scratch());
  picture_.smooth_noise(kTuning.noise_places);
  gradients_.compute(picture_, map, is_mirrored);
  half_ = 0.5f * static_cast<float>(map.side - 1);
}

void PartReader::describe(PartRecord::Blocks blocks, float mm_per_px, std::size_t count, Vec2* mm,
                          std::uint8_t* out) const {
  const Vec2 middle{half_, half_};
  for (std::size_t k = 0; k < count; ++k, out += part_block_bytes(blocks)) {
    const Vec2 at = middle + (1.0f / mm_per_px) * mm[k];
    mm[k] = mm_per_px * (gradients_.describe(at, blocks.cells, blocks.cell_px, out) - middle);
  }
}

void PartReader::run_stage(const PartTable& table, std::size_t number, std::size_t stage) {
  const PartRecord& part = table[number];
  const PartStage w = table.stage(number, stage);
  const std::size_t bytes = part_bytes(part, stage);
  describe(part.stage[stage], part.mm_per_px, part.point_count, mm_, bytes_);
  for (std::size_t k = 0; k < part.point_count; ++k) {
    const auto along = [&](std::size_t row) {
      return w.scale[row] * static_cast<float>(dot_bytes(w.rows + row * bytes, bytes_, bytes)) + w.bias[row];
    };
    mm_[k] = mm_[k] + Vec2{along(2 * k), along(2 * k + 1)};
  }
}

void PartReader::read(const FrameView& frame, const PartTable& table, std::size_t number, const CropMap& map,
                      bool is_mirrored, PartReading* out) {
  const PartRecord& part = table[number];
  const PartShape shape = table.shape(number);
  prepare(frame, map, is_mirrored);
  for (std::size_t k = 0; k < part.point_count; ++k) mm_[k] = {shape.start[2 * k], shape.start[2 * k + 1]};
  for (std::size_t stage = 0; stage < part.stage_count; ++stage) run_stage(table, number, stage);
  const Vec2 right = (1.0f / part.mm_per_px) * map.right;
  const float side = is_mirrored ? -1.0f : 1.0f;
  for (std::size_t k = 0; k < part.point_count; ++k) {
    const float x = side * mm_[k].x, y = mm_[k].y;
    out[k].x = map.origin + Vec2{right.x * x - right.y * y, right.y * x + right.x * y};
    const float* const i = shape.information + 3 * k;
    out[k].information = to_frame_px({i[0], side * i[1], i[2]}, right);
  }
}

}  // namespace pliant
