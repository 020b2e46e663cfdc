#pragma once
// A frame turned by a multiple of an eighth of a turn, in which a face that is turned in the frame is upright.
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/face_box.hpp"
#include "pliant/frame.hpp"

namespace pliant {

/// Tuning of turned pictures. Each constant: unit, reason, experiment.
struct TurnedPictureTuning {
  /// Tangent of the roll up to which an even turn is searched, 30 degrees: up to there the detector finds a face in the first frame
  /// (docs/evaluation.md, *Rolled faces*), and its picture is not reduced. Not tuned.
  float even_turn_tangent = 0.57735027f;
};
inline constexpr TurnedPictureTuning kTurnedPictureTuning{};

/// Turns by which a frame is drawn, in a whole turn.
constexpr int kTurnsOfPicture = 8;
/// The roll of a face that is upright in such a picture, radians.
constexpr float roll_of_turn(int eighths) {
  return 0.785398163f * static_cast<float>(eighths);
}
/// The turn at which a face in that rotation (Pose) is best searched, 0 to 7: an even one up to 30 degrees of roll from it, since
/// the pictures of the odd ones are reduced.
int turn_of(const Quat& rotation);

/// Of the picture of a frame at a turn, px.
struct TurnedSize {
  int width, height;
};
/// \param width, height  of the frame, px, each at most kLargestFramePx. \param eighths  0 to 7.
TurnedSize turned_size(int width, int height, int eighths);

/// A frame, turned about its middle, in as many pixels as the frame has or a few less: a quarter of a turn swaps width and height;
/// an odd number of eighths gives a square, reduced so that it shows the whole frame. What is outside the frame repeats its border.
/// Pixels are interpolated linearly, in integers: the same on every target. Those of the picture are square. Where the frame's are
/// not, the side in which it has more of them is reduced first.
class TurnedPicture {
 public:
  /// Bytes: width times height of the largest frame.
  void lay_out(Arena& arena, int width, int height);

  /// Draws a frame. \param eighths  0 to 7: faces are upright that are turned clockwise by so many eighths of a turn.
  /// \param aspect  as Camera::aspect, 0.5 to 2.
  /// \pre The frame is readable, has at most as many pixels as the layout's, and at most kLargestFramePx a side.
  void draw(const FrameView& frame, int eighths, float aspect = 1);
  /// The picture last drawn, with time and number of its frame.
  const FrameView& view() const { return view_; }

  /// A box in the picture as one in the frame, upright about the same face.
  FaceBox to_frame(const FaceBox& box) const;
  /// A box in the frame as one in the picture.
  FaceBox from_frame(const FaceBox& box) const;

 private:
  static constexpr int kUnit = 65536;
  void draw_line(const FrameView& frame, int y);
  /// One pixel to the right in the picture, in square pixels (scale_); one down is (-y, x) of that.
  Vec2 right() const {
    return (1.0f / kUnit) * Vec2{static_cast<float>(right_x_), static_cast<float>(right_y_)};
  }
  static Vec2 middle_of(const FrameView& f) {
    return 0.5f * Vec2{static_cast<float>(f.width - 1), static_cast<float>(f.height - 1)};
  }

  std::uint8_t* pixels_ = nullptr;
  FrameView view_;
  Vec2 frame_middle_;                           // px of the frame
  Vec2 scale_{1, 1};                            // width and height of a square pixel, px of the frame
  std::int32_t right_x_ = kUnit, right_y_ = 0;  // right(), in 1/kUnit px
};

}  // namespace pliant
