#pragma once
/// \file pyramid.hpp
/// A luma image at full, half, quarter ... size, in an arena.
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/frame.hpp"
#include "pliant/status.hpp"

namespace pliant {

/// An 8-bit luma image in memory that it does not own: row y, column x is data[y * stride + x]. Pixel centres at
/// integers.
struct ImageView {
  const std::uint8_t* data = nullptr;  ///< first pixel
  int width = 0, height = 0;           ///< pixels
  int stride = 0;                      ///< bytes from one row to the next; at least width
};

/// `ok` when the view can be read; `bad_argument` for a null pointer, an empty size or a stride that is too
/// small.
inline Status check(const ImageView& v) {
  return v.data != nullptr && v.width > 0 && v.height > 0 && v.stride >= v.width ? Status::ok
                                                                                 : Status::bad_argument;
}

/// The image as a frame, without a time.
inline FrameView frame_of(const ImageView& image) {
  FrameView frame;
  frame.data = image.data;
  frame.width = image.width;
  frame.height = image.height;
  frame.stride_bytes = static_cast<std::size_t>(image.stride);
  return frame;
}

/// Size and levels of a pyramid. Every frame has exactly this size.
struct PyramidLimits {
  int width = 320, height = 240;  ///< pixels, 8 to 16384
  int levels = 3;                 ///< level 0 included, 1 to Pyramid::kMaxLevels
  /// True: level 0 is a copy of the frame (width * height bytes more), and packed frames (pixel_step_bytes 2) are
  /// accepted. False: level 0 is the frame itself, which must stay valid while the pyramid is used.
  bool copies_frame = true;
};

/// An image pyramid (docs/algorithms.md, section 7.1). Level l + 1 is level l smoothed by the binomial [1 4 6 4 1]^2
/// / 256 (borders reflected about the edge pixel, rounded to nearest) and decimated by 2; its size is half, rounded
/// up, and the point x of level l lies at x / 2. Levels with a side below kMinSide are left out. Integers only.
/// Bytes: 1.33 * width * height, without level 0 0.33 of it. Cost of `build`: about 8 operations a pixel of the
/// frame.
class Pyramid {
 public:
  static constexpr int kMaxLevels = 6;  ///< most levels
  static constexpr int kMinSide = 8;    ///< smallest side of a level, px

  Pyramid() = default;
  Pyramid(const Pyramid&) = delete;
  Pyramid& operator=(const Pyramid&) = delete;

  /// Makes room. \return `bad_argument` for limits out of range, `out_of_memory`; then nothing has changed.
  Status create(Arena& arena, const PyramidLimits& limits);
  /// The same without checks; an arena that measures only counts its bytes.
  void lay_out(Arena& arena, const PyramidLimits& limits);

  /// Fills all levels from `frame`. \return `bad_argument` for an unreadable view, or a packed one without
  /// copies_frame; `size_mismatch` for another size; `not_ready` before `create`; then the levels are as they were.
  Status build(const FrameView& frame);

  /// Number of levels: those asked for, less those with a side below kMinSide. 0 before the first `build`.
  int levels() const { return is_built_ ? levels_ : 0; }
  /// Level `l`. Precondition: 0 <= l < levels().
  const ImageView& level(int l) const {
    PLIANT_ASSERT(l >= 0 && l < levels());
    return views_[l];
  }

  /// Exchanges contents, memory included, in O(1): the current pyramid becomes the previous one.
  void swap(Pyramid& other);

 private:
  ImageView views_[kMaxLevels];
  std::uint8_t* pixels_[kMaxLevels] = {};
  std::uint16_t* line_ = nullptr;  // one row, smoothed down its columns, with room for the reflected border
  int levels_ = 0;
  bool is_built_ = false;
};

}  // namespace pliant
