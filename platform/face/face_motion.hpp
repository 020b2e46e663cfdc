#pragma once
// How far a face has moved in the image between two pictures of one part of it: an alignment whose steps are spread over frames
// follows the face (docs/algorithms.md, section 7.15).
#include <cstdint>

#include "face/face_picture.hpp"

namespace pliant {

/// Tuning of the following. Each constant: unit, reason, experiment.
struct FaceMotionTuning {
  /// Pixels of the picture a side that are one pixel compared. With 8 the search of profile S finds fewer faces that move
  /// (docs/experiments.md, Searches and first checks).
  int factor = 4;
  /// What is left out at each border of the picture, pixels compared: the rest is the face, and little of what is behind it.
  int border = 8;
  /// Range of the search each way, pixels compared: 0.32 of the side of the face box. With 12 as many faces are found.
  int range = 9;
  /// Correlation, at least, for a motion. Round value, not tuned.
  float least_correlation = 0.5f;
};
inline constexpr FaceMotionTuning kFaceMotionTuning{};

/// Memory of a comparison. `kept` must stay as it is from `keep` to `since_kept`.
struct FaceMotion {
  static constexpr int kSide = kFacePictureTuning.side_px / kFaceMotionTuning.factor;
  std::uint8_t kept[kSide * kSide], now[kSide * kSide];
  std::uint16_t line[kFacePictureTuning.side_px];

  /// \param picture  of full side.
  void keep(const FacePicture& picture) { reduce(picture, kept); }
  /// The motion of the face, px of the frame; none where the pictures are too different.
  /// \param picture  of the same part of a later frame. Cost: about 80 shifts of 24 x 24 pixels.
  Vec2 since_kept(const FacePicture& picture);

 private:
  void reduce(const FacePicture& picture, std::uint8_t* out);
};

}  // namespace pliant
