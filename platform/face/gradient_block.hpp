#pragma once
// Gradient blocks: a square of cells around a pixel as bytes that a linear regression reads.
#include <cstdint>

#include "face/aligner_table.hpp"
#include "face/gradient_cells.hpp"

namespace pliant {

/// Describes squares of cells of an upright crop that has a border of one pixel.
class GradientBlocks {
 public:
  void lay_out(Arena& arena);

  /// The crop to be described next: (side + 2)^2 bytes, which must stay valid.
  void set_crop(const std::uint8_t* pixels, int side) {
    pixels_ = pixels;
    side_ = side;
  }

  /// Describes the block of cells x cells cells around a position. The middle is rounded to a pixel, and moved so that the block
  /// lies in the crop. Integers only. Cost: about 40 operations a pixel of the block.
  /// \param at   crop px, finite.
  /// \param out  cells * cells * kBlockChannels bytes: each the square root of the part of the block's gradient that is in one
  ///             cell and direction. The gain of the light drops out, and strong edges do not outweigh the rest.
  /// \return the middle of the block, crop px.
  Vec2 describe(Vec2 at, int cells, int cell_px, std::uint8_t* out) const;

 private:
  const std::uint8_t* pixels_ = nullptr;
  int side_ = 0;
  CellSums* sums_ = nullptr;
};

/// sum of weight[k] * value[k].
std::int32_t dot_bytes(const std::int8_t* weight, const std::uint8_t* value, std::size_t count);

}  // namespace pliant
