#pragma once
// A frame at a smaller size, line by line, without memory for the whole.
#include <cstdint>

#include "pliant/face_detector.hpp"
#include "pliant/frame.hpp"

namespace pliant {

/// Lines of a frame reduced by a ratio of at least 1. A pixel is the mean over the area that it covers; above
/// a ratio of kLargestAreaRatio it is the mean of 4 x 4 pixels spread over that area, so that the cost stays
/// bounded. Beyond its border the picture repeats its border pixels. Integers only.
class ScaledLines {
 public:
  static constexpr int kUnit = 256;                    ///< of ratios: pixels of the frame a pixel, times 256
  static constexpr int kLargestAreaRatio = 4 * kUnit;  ///< up to which a pixel is the mean of all
  static constexpr int kLargestRatio =
      kLargestFramePx / 32 * kUnit;  ///< of the largest frame reduced to 32 px

  ScaledLines() = default;
  /// \pre The frame is readable and has at most kLargestFramePx pixels a side; kUnit <= ratio <= kLargestRatio.
  ScaledLines(const FrameView& frame, int ratio);

  int width() const { return width_; }    ///< Whole pixels a line; may be 0.
  int height() const { return height_; }  ///< Lines.

  /// Writes pixels x to x + count - 1 of line y; both may lie beyond the border.
  /// \param scratch  `count` elements.
  /// \pre width() and height() are at least 1.
  void read(int x, int y, int count, std::uint32_t* scratch, std::uint8_t* out) const;

 private:
  void copy(int x, int y, int count, std::uint8_t* out) const;
  void average(int x, int y, int count, std::uint32_t* sums, std::uint8_t* out) const;
  void add_line(const std::uint8_t* line, int x, int count, std::uint32_t weight, std::uint32_t* sums) const;
  void sample(int x, int y, int count, std::uint8_t* out) const;
  const std::uint8_t* line(int y) const {
    return frame_.data + static_cast<std::size_t>(y) * frame_.stride_bytes;
  }

  FrameView frame_;
  int ratio_ = kUnit, width_ = 0, height_ = 0;
};

}  // namespace pliant
