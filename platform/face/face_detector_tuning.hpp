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
  /// Overlap above which two hits are the same face: two faces may touch, but one is not in front of the other. Not tuned.
  float same_face_overlap = 0.2f;
  /// Overlap above which hits are averaged. Not tuned.
  float averaged_overlap = 0.5f;
};
inline constexpr FaceDetectorTuning kFaceDetectorTuning{};

}  // namespace pliant
