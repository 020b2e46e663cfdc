#pragma once
// Constants of face detection that were chosen.

namespace pliant {

/// Tuning of face detection. Each constant: unit, reason, experiment.
struct FaceDetectorTuning {
  /// Cells by which windows may reach beyond the frame, where its border pixels repeat: faces that the border cuts. Not
  /// tuned.
  int beyond_cells = 3;
  /// Smallest side of a reduced frame, px: the largest face box is 1.2 times the frame's smaller side. Not tuned.
  int smallest_level_px = 40;
  /// Fraction of the smaller of two boxes that they share, above which the less clear hit is dropped: equal faces side by side are
  /// 0.6 sides apart or more, and an eye within a face is no second one. Not tuned.
  float same_face_fraction = 0.4f;
  /// Overlap above which hits are averaged. Not tuned.
  float averaged_overlap = 0.5f;
  /// Ratio of sides, and distance of middles in sides, up to which a window is near a box: two sizes, since a face that
  /// comes while a search in parts has passed its size is found with a box 1.3 times as small. Not tuned.
  float near_ratio = 1.5f, near_reach = 0.25f;
};
inline constexpr FaceDetectorTuning kFaceDetectorTuning{};

}  // namespace pliant
