#pragma once
// Where a sliding window is: size, strip and row.
#include "pliant/face_box.hpp"

namespace pliant {

/// Enumerates the rows of cells of all strips of a frame at all sizes, from the largest faces to the smallest, whose search takes
/// longest. Wide frames are cut into strips that share kWindowCells - 1 columns, so that memory does not grow with the frame.
class SearchPlace {
 public:
  /// The most columns of a strip of a frame up to `width` px wide.
  static int most_columns(int width);

  /// The first row for a frame of this size; complete at once if no face box fits.
  void begin(int width, int height, int smallest_px);
  /// The same for windows near a box alone, of any size about its own (FaceDetectorTuning::near_ratio, near_reach).
  /// \pre The box is finite.
  void begin_near(int width, int height, int smallest_px, const FaceBox& box);
  /// To the next row. \pre !is_complete().
  void advance();

  bool is_complete() const { return is_complete_; }
  bool is_of(int width, int height) const { return width == width_ && height == height_; }
  int ratio() const { return ratio_; }          ///< of the frame to the reduced one, in 1/ScaledLines::kUnit
  int first_column() const { return column_; }  ///< of the strip, in cells of the reduced frame
  int columns() const { return columns_; }      ///< of the strip
  int row() const { return row_; }              ///< in cells of the reduced frame
  bool begins_strip() const { return row_ == first_row_; }
  int first_row() const { return first_row_; }  ///< of the strip
  /// The box, in the frame, of the window whose first cell is `k` columns right of the strip's first, in `row`.
  FaceBox box(int k, int row) const;

 private:
  struct Cells {
    int begin, end;
  };
  int ratio_of(int size) const;
  void begin_size();
  Cells cells_along(int px, float middle) const;
  void begin_strip();

  FaceBox near_;  // side 0: the whole frame
  int width_ = 0, height_ = 0, first_ratio_ = 0, size_ = 0, ratio_ = 0;
  int first_row_ = 0, end_column_ = 0, end_row_ = 0;  // of the cells at this size
  int column_ = 0, columns_ = 0, row_ = 0;
  bool is_complete_ = true;
};

}  // namespace pliant
