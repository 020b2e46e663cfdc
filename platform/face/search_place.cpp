#include "face/search_place.hpp"

#include "base/integers.hpp"
#include "face/detector_table.hpp"
#include "face/face_detector_tuning.hpp"
#include "face/scaled_lines.hpp"

namespace pliant {

namespace {

constexpr const FaceDetectorTuning& kTuning = kFaceDetectorTuning;

// Columns of a strip: a frame of 320 px in one piece, with what may lie beyond its border.
constexpr int kStripColumns = 320 / kDetectorCellPx + 2 * kTuning.beyond_cells;
// Four sizes an octave: 2^(k/4), in 1/256.
constexpr int kSizesAnOctave = 4;
constexpr int kSizes[kSizesAnOctave] = {256, 304, 362, 431};

constexpr int cells(int pixels) {
  return (pixels + kDetectorCellPx - 1) / kDetectorCellPx;
}

}  // namespace

int SearchPlace::most_columns(int width) {
  const int all = cells(width) + 2 * kTuning.beyond_cells;
  return all < kWindowCells ? kWindowCells : smaller(all, kStripColumns);
}

void SearchPlace::begin(int width, int height, int smallest_px) {
  begin_near(width, height, smallest_px, {});
}

void SearchPlace::begin_near(int width, int height, int smallest_px, const FaceBox& box) {
  near_ = box;
  width_ = width;
  height_ = height;
  const int smallest = larger(smallest_px, kWindowPx);
  first_ratio_ = smallest * ScaledLines::kUnit / kWindowPx;
  size_ = 0;
  while (smaller(width, height) * ScaledLines::kUnit / ratio_of(size_) >= kTuning.smallest_level_px) ++size_;
  begin_size();
}

int SearchPlace::ratio_of(int size) const {
  return (first_ratio_ * kSizes[size % kSizesAnOctave] / 256) << (size / kSizesAnOctave);
}

// Of the reduced frame, whose side is `px`: all, or those of windows whose middle is near `middle`, px of the frame.
SearchPlace::Cells SearchPlace::cells_along(int px, float middle) const {
  const Cells all{-kTuning.beyond_cells, cells(px) + kTuning.beyond_cells};
  if (!(near_.side > 0)) return all;
  const float ratio = static_cast<float>(ratio_) / ScaledLines::kUnit;
  const auto window = [&](float x) {
    return static_cast<int>((clamp(x, 0, ratio * static_cast<float>(px)) / ratio - 0.5f * kWindowPx) /
                            kDetectorCellPx);
  };
  const float reach = kTuning.near_reach * near_.side;
  const int begin = window(middle - reach), end = window(middle + reach) + kWindowCells;
  return {larger(begin, all.begin), smaller(end, all.end)};
}

// Below this size the next one that is asked for.
void SearchPlace::begin_size() {
  const bool is_whole = !(near_.side > 0);
  while (size_ > 0) {
    ratio_ = ratio_of(--size_);
    const int width = width_ * ScaledLines::kUnit / ratio_, height = height_ * ScaledLines::kUnit / ratio_;
    const float side = box(0, 0).side;
    if (!is_whole && side > kTuning.near_ratio * near_.side) continue;
    if (!is_whole && side * kTuning.near_ratio < near_.side) break;
    const Cells columns = cells_along(width, near_.center.x), rows = cells_along(height, near_.center.y);
    column_ = columns.begin;
    end_column_ = columns.end;
    first_row_ = rows.begin;
    end_row_ = rows.end;
    is_complete_ = false;
    begin_strip();
    return;
  }
  is_complete_ = true;
}

void SearchPlace::begin_strip() {
  columns_ = smaller(end_column_ - column_, kStripColumns);
  row_ = first_row_;
}

void SearchPlace::advance() {
  PLIANT_ASSERT(!is_complete_);
  if (++row_ < end_row_) return;
  const bool is_last_strip = column_ + columns_ >= end_column_;
  if (is_last_strip) {
    begin_size();
  } else {
    column_ += columns_ - (kWindowCells - 1);
    begin_strip();
  }
}

FaceBox SearchPlace::box(int k, int row) const {
  const float ratio = static_cast<float>(ratio_) / ScaledLines::kUnit;
  const auto middle = [ratio](int cell) {
    return ratio * static_cast<float>(cell * kDetectorCellPx + kWindowPx / 2) - 0.5f;
  };
  return {{middle(column_ + k), middle(row)}, ratio * kWindowPx};
}

}  // namespace pliant
