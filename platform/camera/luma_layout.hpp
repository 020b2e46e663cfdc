#pragma once
// Where the luma of a camera's buffer is, and which of a camera's formats to ask for. Formats are given by their codes:
// libcamera is not needed.
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pliant/frame.hpp"

namespace pliant {

/// A pixel format's four characters as one number, the first in the lowest byte (DRM's codes, which libcamera uses).
constexpr std::uint32_t fourcc(char a, char b, char c, char d) {
  return static_cast<std::uint32_t>(static_cast<unsigned char>(a)) |
         static_cast<std::uint32_t>(static_cast<unsigned char>(b)) << 8 |
         static_cast<std::uint32_t>(static_cast<unsigned char>(c)) << 16 |
         static_cast<std::uint32_t>(static_cast<unsigned char>(d)) << 24;
}
/// A code as text for messages, "YUYV"; a byte that cannot be printed is a '?'.
std::string fourcc_text(std::uint32_t code);

/// Luma of 8 bits inside the first plane of a format.
struct LumaLayout {
  std::uint32_t format = 0;
  int first_byte = 0;        ///< of a pixel's luma: 0, or 1 where chroma comes first (UYVY)
  int pixel_step_bytes = 1;  ///< 1 planar, 2 packed
};

/// The layout of a format; null if its luma cannot be read in place (compressed, RGB, Bayer, more than 8 bits).
const LumaLayout* luma_layout(std::uint32_t format);

/// The plane of one frame in memory: `length` readable bytes from `bytes`.
struct PlaneMemory {
  const std::uint8_t* bytes = nullptr;
  std::size_t length = 0;
};

/// Points `view` at the luma of a plane, without a copy. A stride of 0 means rows without padding.
/// \return `bad_argument` for a null plane, an empty size or a stride shorter than a row; `truncated` if the plane
///         ends before the last pixel; then the view is as it was. Its time and sequence always are.
Status view_luma(const LumaLayout& layout, PlaneMemory plane, int width, int height, std::size_t stride_bytes,
                 FrameView* view);

/// A format that a camera offers, and its sizes; no sizes: any.
struct FormatOffer {
  std::uint32_t format = 0;
  struct Size {
    int width = 0, height = 0;
  };
  std::vector<Size> sizes;
};

/// Chooses what to ask a camera for: the size nearest to width x height in a format whose luma can be read. Of
/// several formats planar ones are preferred, because they are read without a copy. \return false if there is none.
bool choose_format(const std::vector<FormatOffer>& offers, int width, int height, std::uint32_t* format,
                   FormatOffer::Size* size);

}  // namespace pliant
