#pragma once
/// \file frame.hpp
/// A view of one camera frame: the only input that the vision code takes from a camera or a file.
#include <cstddef>
#include <cstdint>

#include "pliant/status.hpp"

namespace pliant {

/// A luma image of 8 bits a pixel in memory of the caller, which must stay valid until the call that takes the view
/// returns. Row y, column x is data[y * stride_bytes + x * pixel_step_bytes]. The step is 1 in planar luma (YUV420,
/// NV12, R8) and 2 in packed YUYV. A tracker copies the frame, unless TrackerLimits::copies_frame is false: then the
/// step must be 1.
struct FrameView {
  const std::uint8_t* data = nullptr;  ///< first pixel
  int width = 0, height = 0;           ///< pixels
  std::size_t stride_bytes = 0;  ///< from one row to the next; at least (width - 1) * pixel_step_bytes + 1
  int pixel_step_bytes = 1;      ///< from one pixel to the next; 1 or 2
  /// Time of exposure, from any origin. A tracker refuses a frame in which neither time nor number has grown: stale_frame.
  std::int64_t time_ns = 0;
  std::uint32_t sequence = 0;  ///< number of the frame, modulo 2^32; a gap means dropped frames
};

/// `ok` when the view can be read; `bad_argument` for a null pointer, an empty size, a stride that is too small, or one with
/// which the rows are more than half of the address space (a negative one).
inline Status check(const FrameView& f) {
  if (f.data == nullptr || f.width <= 0 || f.height <= 0 || f.pixel_step_bytes < 1 || f.pixel_step_bytes > 2)
    return Status::bad_argument;
  const std::size_t row =
      static_cast<std::size_t>(f.width - 1) * static_cast<std::size_t>(f.pixel_step_bytes) + 1;
  const std::size_t most = (~std::size_t{0} >> 1) / static_cast<std::size_t>(f.height);
  return f.stride_bytes >= row && f.stride_bytes <= most ? Status::ok : Status::bad_argument;
}

}  // namespace pliant
