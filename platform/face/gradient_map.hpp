#pragma once
// Gradients of an upright crop of a face, a pixel each, and blocks of cells summed from them anywhere: the
// bytes that a linear regression reads. The cells of gradient_cells.hpp lie on a fixed grid; these lie around
// a landmark.
#include <cstdint>

#include "face/face_picture.hpp"
#include "face/gradient_sums.hpp"
#include "pliant/arena.hpp"

namespace pliant {

constexpr int kMostCropPx = 104;  // a side of the crop

/// The gradients of one crop. Integers only.
class GradientMap {
 public:
  /// \param most_side  of a crop, px. Bytes: two a pixel of the largest crop.
  void lay_out(Arena& arena, int most_side = kMostCropPx);

  /// Cuts the crop out of the picture and takes its gradients. Cost: about 60 operations a pixel.
  /// \param is_mirrored  takes the mirror image of the crop.
  /// \pre map.side is at most that of lay_out.
  void compute(const FacePicture& picture, const CropMap& map, bool is_mirrored = false);

  /// Describes the block of cells x cells cells around a position. The middle is rounded to a pixel, and
  /// moved so that the block lies in the crop. Cost: about 10 operations a pixel of the block.
  /// \param at   crop px, finite.
  /// \param out  cells * cells * kBlockChannels bytes: each the square root of the part of the block's
  ///             gradient that is in one cell and direction. The gain of the light drops out, and strong
  ///             edges do not outweigh the rest.
  /// \return the middle of the block, crop px.
  Vec2 describe(Vec2 at, int cells, int cell_px, std::uint8_t* out) const;

  /// The memory of the gradients, free for other use until the next `compute`.
  int* scratch() { return reinterpret_cast<int*>(gradients_); }

 private:
  int side_ = 0, most_side_ = 0;
  std::uint16_t* gradients_ = nullptr;  // packed
  std::uint16_t* sums_ = nullptr;       // of the block being described
};

/// The block of the mirrored picture. \param out  not `block`.
void mirror_block(const std::uint8_t* block, int cells, std::uint8_t* out);

/// sum of weight[k] * value[k].
std::int32_t dot_bytes(const std::int8_t* weight, const std::uint8_t* value, std::size_t count);

}  // namespace pliant
