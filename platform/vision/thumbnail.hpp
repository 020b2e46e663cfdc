#pragma once
// Thumbnails: frames reduced to a few thousand pixels for coarse search.
#include <cstdint>

#include "pliant/frame.hpp"

namespace pliant {

/// The factor by which a frame of this width is reduced: the smallest power of two, up to 64, that leaves at most
/// `columns`.
constexpr int thumbnail_factor(int width, int columns) {
  int factor = 1;
  while (width / factor > columns && factor < 64) factor *= 2;
  return factor;
}

/// Writes the rounded mean of each block of factor x factor pixels, taken over every other row. Pixels at the right
/// and lower border that do not fill a block are left out. Integers only.
/// \param line  scratch, factor * (width / factor) elements.
/// \param out   (width / factor) x (height / factor) pixels without padding.
/// Precondition: a readable frame, factor a power of two, up to 64 and not larger than a side of the frame.
/// Cost: half an operation a pixel.
void make_thumbnail(const FrameView& frame, int factor, std::uint16_t* line, std::uint8_t* out);

/// Multiplies each row by a gain that gives all rows about the same mean, 96 but for pixels that are cut at 255. A sensor
/// with a rolling shutter draws bands of light over the picture under a lamp that flickers with the mains. They move on from
/// frame to frame, and a search that compares thumbnails would follow them. Integers only.
/// \param pixels  columns x rows without padding, at least one column, at most 16,384.
/// Cost: three operations a pixel.
void level_rows(std::uint8_t* pixels, int columns, int rows);

}  // namespace pliant
