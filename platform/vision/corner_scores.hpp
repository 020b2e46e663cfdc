#pragma once
// The Shi-Tomasi measure, a row of pixels at a time: gradients once a pixel, running sums down the columns, a window
// sum along the row. All are integers until the eigenvalue, so that a row's scores do not depend on where the scan
// started.
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/corners.hpp"

namespace pliant::corners {

/// The window that is summed over, px.
constexpr int kRadius = 3, kWindow = 2 * kRadius + 1;
static_assert(kCornerMargin == kRadius + 1, "a gradient needs one pixel more");

/// Sums of products of Scharr gradients over the window. Gradients have a gain of 32: sums are at most 49 * 4080^2 <
/// 2^30.
struct Tensor {
  std::int32_t xx, xy, yy;
};
/// The smaller eigenvalue of the mean structure tensor, (grey/px)^2.
float score_of(const Tensor& t);

/// Scores the columns [first, end) of one row after the other. All scored pixels keep kCornerMargin from the border.
class RowScorer {
 public:
  /// \param columns  scored at most.
  void lay_out(Arena& arena, int columns);
  /// The first call of `next` gives row y.
  void start(const ImageView& image, int first, int end, int y);
  /// Gives lambda_min of the next row, one value a column; 0 where lambda_min / lambda_max is below min_ratio.
  void next(float min_ratio, float* scores);

 private:
  void add_row(int y, int sign);

  const ImageView* image_ = nullptr;
  int first_ = 0, columns_ = 0, y_ = 0;
  std::int16_t* gx_[kWindow] = {};  // of the rows in the window; row y is at y % kWindow
  std::int16_t* gy_[kWindow] = {};
  std::int32_t *xx_ = nullptr, *xy_ = nullptr, *yy_ = nullptr;  // sums down the columns
  std::int32_t *wxx_ = nullptr, *wxy_ = nullptr, *wyy_ = nullptr;
  std::int16_t* smooth_ = nullptr;  // one row, smoothed down its columns
};

}  // namespace pliant::corners
