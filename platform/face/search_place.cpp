#include "face/search_place.hpp"

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

constexpr int smaller(int a, int b) {
  return a < b ? a : b;
}

constexpr int cells(int pixels) {
  return (pixels + kDetectorCellPx - 1) / kDetectorCellPx;
}

}  // namespace

int SearchPlace::most_columns(int width) {
  const int all = cells(width) + 2 * kTuning.beyond_cells;
  return all < kWindowCells ? kWindowCells : smaller(all, kStripColumns);
}

int SearchPlace::first_row() {
  return -kTuning.beyond_cells;
}

void SearchPlace::begin(int width, int height, int smallest_px) {
  width_ = width;
  height_ = height;
  const int smallest = smallest_px < kWindowPx ? kWindowPx : smallest_px;
  first_ratio_ = smallest * ScaledLines::kUnit / kWindowPx;
  size_ = 0;
  begin_size();
}

void SearchPlace::begin_size() {
  ratio_ = (first_ratio_ * kSizes[size_ % kSizesAnOctave] / 256) << (size_ / kSizesAnOctave);
  const int width = width_ * ScaledLines::kUnit / ratio_, height = height_ * ScaledLines::kUnit / ratio_;
  is_complete_ = width < kTuning.smallest_level_px || height < kTuning.smallest_level_px;
  end_column_ = cells(width) + kTuning.beyond_cells;
  end_row_ = cells(height) + kTuning.beyond_cells;
  column_ = -kTuning.beyond_cells;
  begin_strip();
}

void SearchPlace::begin_strip() {
  columns_ = smaller(end_column_ - column_, kStripColumns);
  row_ = first_row();
}

void SearchPlace::advance() {
  PLIANT_ASSERT(!is_complete_);
  if (++row_ < end_row_) return;
  const bool is_last_strip = column_ + columns_ >= end_column_;
  if (is_last_strip) {
    ++size_;
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
