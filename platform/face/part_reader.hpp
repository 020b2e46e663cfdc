#pragma once
// Reads points of a part of a face (an eye, the mouth) from a small upright crop (docs/algorithms.md, section
// 7.19). Runtime and training run the same code.
#include "face/face_picture.hpp"
#include "face/gradient_map.hpp"
#include "face/part_table.hpp"
#include "pliant/camera.hpp"

namespace pliant {

/// A point that was read.
struct PartReading {
  Vec2 x;            ///< px of the frame
  Sym2 information;  ///< 1/px^2, as measured on people who did not train it
};

/// Axes of an upright crop: px of the frame a millimetre of the face, around the frame's first pixel.
CropMap upright(const View& view);
/// The crop of a part.
/// \param middle  between the anchors, px of the frame.
CropMap crop_of_part(const PartRecord& part, const View& view, Vec2 middle);

/// Cuts out crops, and reads points from them. Bytes: about 24 KiB.
class PartReader {
 public:
  void lay_out(Arena& arena);

  void set_aspect(float aspect) { picture_.set_aspect(aspect); }  ///< As FacePicture::set_aspect.
  /// Cuts out a crop, or its mirror image.
  void prepare(const FrameView& frame, const CropMap& map, bool is_mirrored);
  /// Describes the block around each of `count` points of the crop.
  /// \param mm      from the crop's middle. In: where the points are. Out: the middles of their blocks.
  /// \param out     the blocks, one after the other.
  void describe(PartRecord::Blocks blocks, float mm_per_px, std::size_t count, Vec2* mm,
                std::uint8_t* out) const;
  /// Reads all points of a part. \param out  point_count readings.
  void read(const FrameView& frame, const PartTable& table, std::size_t part, const CropMap& map,
            bool is_mirrored, PartReading* out);
  /// The points last read, mm from the middle of the crop, or of its mirror image.
  const Vec2* read_mm() const { return mm_; }

 private:
  void run_stage(const PartTable& table, std::size_t part, std::size_t stage);

  FacePicture picture_;
  GradientMap gradients_;
  float half_ = 0;  // of the crop, px
  std::uint8_t* bytes_ = nullptr;
  Vec2* mm_ = nullptr;  // of the points
};

}  // namespace pliant
