#pragma once
// A whole frame in a few thousand pixels: enough to see where the model has gone.
#include <cstddef>
#include <cstdint>

#include "pliant/frame.hpp"

namespace pliant {

/// By how much a frame of this width is reduced: the least power of two that leaves at most so many columns.
constexpr int thumbnail_factor(int width, int columns) {
  int factor = 1;
  while (width / factor > columns && factor < 64) factor *= 2;
  return factor;
}

/// Means over factor x factor pixels, of every other row; what does not fill a block is left out.
/// \param line  factor * (width / factor) values of scratch. \param out  (width / factor) x (height / factor).
void make_thumbnail(const FrameView& frame, int factor, std::uint16_t* line, std::uint8_t* out);

}  // namespace pliant
