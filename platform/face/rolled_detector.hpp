#pragma once
// Finds faces that are turned in the frame (docs/algorithms.md, section 7.12).
#include "face/turned_picture.hpp"
#include "pliant/face_detector.hpp"

namespace pliant {

/// Tuning of the search at other rolls. Each constant: unit, reason, experiment.
struct RolledDetectorTuning {
  /// Of so many searches of a whole frame the last one is at another turn, count. With 3 an upright face is found a frame later in
  /// a third of the cases, and all turns have been searched after 21 searches, 0.7 s at 30 frames a second. Round value, not tuned.
  int period = 3;
  /// Larger over smaller side of a pixel above which the frame is searched in a picture of square pixels, no unit. Without such a
  /// picture 30 of 30 portraits are found with an aspect of 1.5, 23 with 2 and 18 with 0.5.
  float least_unlike = 1.2f;
};
inline constexpr RolledDetectorTuning kRolledDetectorTuning{};

/// A detector that searches the frame upright and, now and then, turned. A frame whose pixels are about square is searched as it is
/// where it is upright, else in a picture. Frames are readable and within the limits.
class RolledDetector : public FaceDetector {
 public:
  /// As FaceDetector::lay_out, and a picture. \param expected  rotation of a face: most searches are at its turn (turn_of).
  /// \param aspect  of the frames, as Camera::aspect.
  void lay_out(Arena& arena, const Span<const std::uint8_t>& table, const FaceDetectorLimits& limits,
               const Quat& expected, float aspect = 1);

  /// As FaceDetector::find, at one turn. The boxes found are in the frame.
  Status find_at(int turn, const FrameView& frame, Span<DetectedFace> room, std::size_t* count);
  /// As FaceDetector::search; whole frames are searched at one turn each.
  Status search(const FrameView& frame, std::uint32_t work, Span<DetectedFace> room, std::size_t* count,
                bool* is_complete);
  /// As FaceDetector::search_near, at one turn: that of the face that was detected there before, or, of a place where none was, the
  /// expected one. \param face  in: that face; a score of 0: none.
  Status search_near(const FrameView& frame, const FaceBox& box, DetectedFace* face);

 private:
  static constexpr const RolledDetectorTuning& kTuning = kRolledDetectorTuning;
  int next_turn();
  /// Whether a search at that turn is of the picture, else of the frame itself.
  bool draws(int turn) const { return turn != 0 || aspect_ != 1; }
  const FrameView& turned(const FrameView& frame, int turn);
  void to_frame(int turn, Span<DetectedFace> faces) const;

  TurnedPicture picture_;
  float aspect_ = 1;         // 1: near enough
  int expected_ = 0;         // turn
  int searches_ = 0;         // begun in this round
  int turn_ = 0;             // of the last one
  bool is_complete_ = true;  // the last one is
};

}  // namespace pliant
