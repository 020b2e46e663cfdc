#pragma once
// Pictures of one face: the part of a frame around it, reduced to a fixed size, and the upright crop that is
// read from it.
#include <cstdint>

#include "face/picture_noise.hpp"
#include "pliant/arena.hpp"
#include "pliant/camera.hpp"
#include "pliant/frame.hpp"
#include "pliant/geometry.hpp"
#include "pliant/pyramid.hpp"

namespace pliant {

/// Tuning of the pictures of a face. Each constant: unit, reason, experiment.
struct FacePictureTuning {
  /// Side of the reduced picture, px. With `face_px` it reaches 107 mm to each side of the face's middle.
  int side_px = 160;
  /// Side of the face box in the reduced picture, px: 1.3 mm a pixel, near the finest crop.
  float face_px = 112;
  /// Samples a side that are averaged to one pixel, at most: bounds the time on huge faces.
  int most_samples = 6;
};
inline constexpr FacePictureTuning kFacePictureTuning{};
static_assert(kFacePictureTuning.side_px <= kMostPictureSide, "");

/// An upright square that is cut out of a picture: the position `origin` is the crop's middle.
struct CropMap {
  Vec2 origin;   ///< px of the frame
  Vec2 right;    ///< one crop pixel to the right, in px of the frame; down is (-right.y, right.x)
  int side = 0;  ///< crop px

  Vec2 to_frame(Vec2 crop) const { return origin + along(crop - middle()); }
  /// A displacement in crop px, in px of the frame.
  Vec2 along(Vec2 d) const { return {right.x * d.x - right.y * d.y, right.y * d.x + right.x * d.y}; }
  /// The inverse of to_frame.
  Vec2 to_crop(Vec2 frame) const;

 private:
  Vec2 middle() const { return {0.5f * static_cast<float>(side - 1), 0.5f * static_cast<float>(side - 1)}; }
};

/// Information of a displacement in a crop's millimetres, in px of the frame: R W R^T / |a|^2 with R = [a.x -a.y; a.y a.x] / |a|.
/// \param a  one millimetre to the crop's right, px of the frame.
Sym2 to_frame_px(Sym2 w, Vec2 a);

/// The part of a frame around a face, reduced by averaging where it is large. Beyond the frame its border pixels go on. Where the
/// frame's pixels are not square, those of the picture are: px of the frame are then of one whose y is divided by the aspect.
class FacePicture {
 public:
  /// \param side  px, 2 to 160. Bytes: its square.
  void lay_out(Arena& arena, int side = kFacePictureTuning.side_px);

  /// Makes the picture smaller until the next call. \param side  px, 2 to that of lay_out.
  void set_side(int side) { side_ = side; }
  void set_aspect(float aspect) { aspect_ = aspect; }  ///< As Camera::aspect; 1 unless set.
  /// \param centre   of the part, px of the frame; finite.
  /// \param ratio    px of the frame a pixel of this picture; below 1 counts as 1. Finite.
  /// \param columns  scratch, side * most_samples values.
  void take(const FrameView& frame, Vec2 centre, float ratio, int* columns);
  /// Smooths the picture as taken if it is noisy (picture_noise.hpp).
  void smooth_noise(int most_places) { pliant::smooth_noise(pixels_, side_, most_places); }

  /// As taken: the middle of the part, px of the frame, and px of the frame a pixel.
  Vec2 centre() const { return first_ + 0.5f * ratio_ * Vec2{last(), last()}; }
  float ratio() const { return ratio_; }
  int side() const { return side_; }                      ///< px
  const std::uint8_t* pixels() const { return pixels_; }  ///< side squared, rows without padding
  /// A position in px of the frame, in px of this picture.
  Vec2 from_frame(Vec2 x) const { return (1.0f / ratio_) * (x - first_); }
  Vec2 along_from_frame(Vec2 d) const { return (1.0f / ratio_) * d; }  ///< The same of a displacement.

 private:
  float last() const { return static_cast<float>(side_ - 1); }

  int side_ = 0;
  std::uint8_t* pixels_ = nullptr;
  Vec2 first_;       // px of the frame: the middle of pixel (0, 0)
  float ratio_ = 1;  // px of the frame a pixel
  float aspect_ = 1;
};

/// What is upright in crops of a face: its own vertical as the camera sees it, downwards; unit. Down in the image where the
/// camera looks along it.
Vec2 down_of(const Projector& projector);

/// Reads the rows of an upright crop, with one pixel more on each side, by bilinear interpolation.
class CropReader {
 public:
  CropReader(const FacePicture& picture, const CropMap& map);
  /// \param y    -1 to side. \param out  side + 2 pixels, from crop position -1 on.
  void read_row(int y, std::uint8_t* out) const;

 private:
  const std::uint8_t* pixels_;
  int count_, picture_side_;
  std::int32_t first_x_, first_y_, step_x_, step_y_;  // 1/65536 px
};

}  // namespace pliant
