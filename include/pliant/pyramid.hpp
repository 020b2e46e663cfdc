#pragma once
/// \file pyramid.hpp
/// A luma picture at full, half, quarter ... size, in an arena.
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/frame.hpp"
#include "pliant/status.hpp"

namespace pliant {

/// 8-bit luma in somebody else's memory: row y, column x is data[y * stride + x]. Pixel centres at integers.
struct ImageView {
  const std::uint8_t* data = nullptr;
  int width = 0, height = 0;  ///< pixels
  int stride = 0;             ///< bytes from one row to the next; at least width
};

/// `ok` when the view can be read; `bad_argument` for a null pointer, an empty size or a stride that is too
/// small.
inline Status check(const ImageView& v) {
  return v.data != nullptr && v.width > 0 && v.height > 0 && v.stride >= v.width ? Status::ok
                                                                                 : Status::bad_argument;
}

/// What a pyramid is made for. Its frames have exactly this size.
struct PyramidLimits {
  int width = 320, height = 240;  ///< pixels, 8 to 16384
  int levels = 3;                 ///< level 0 included, 1 to Pyramid::kMaxLevels
  /// True: level 0 is a copy of the frame (width * height bytes more), which may then go away, and packed
  /// frames (pixel_step_bytes 2) are accepted. False: level 0 is the caller's memory, which must outlive the
  /// use of the pyramid.
  bool copies_frame = true;
};

/// Level l + 1 is level l smoothed by the binomial [1 4 6 4 1]^2 / 256 (borders reflected about the edge
/// pixel, rounded to nearest) and decimated by 2; its size is half, rounded up, and the point x of level l
/// lies at x / 2. Levels with a side below kMinSide are left out. Integers only. Bytes: 1.33 * width *
/// height, without level 0 0.33 of it. Cost of `build`: about 8 operations a pixel of the frame.
class Pyramid {
 public:
  static constexpr int kMaxLevels = 6;
  static constexpr int kMinSide = 8;

  Pyramid() = default;
  Pyramid(const Pyramid&) = delete;
  Pyramid& operator=(const Pyramid&) = delete;

  /// `bad_argument` for limits out of range, `out_of_memory`; then nothing has changed.
  Status create(Arena& arena, const PyramidLimits& limits);
  void lay_out(Arena& arena, const PyramidLimits& limits);

  /// Fills all levels from `frame`. `bad_argument` for an unreadable view (or a packed one, without
  /// copies_frame), `size_mismatch` for another size, `not_ready` before `create`; then the levels are as
  /// they were.
  Status build(const FrameView& frame);

  /// Levels there are: those asked for, less those that would be too small. 0 before the first `build`.
  int levels() const { return is_built_ ? levels_ : 0; }
  /// Level `l` in 0 .. levels() - 1.
  const ImageView& level(int l) const { return views_[l]; }

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
