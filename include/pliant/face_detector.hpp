#pragma once
/// \file face_detector.hpp
/// Finds faces in a frame, without anything known before.
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/face_box.hpp"
#include "pliant/frame.hpp"
#include "pliant/status.hpp"

namespace pliant {

/// A face in a frame.
struct DetectedFace {
  FaceBox box;      ///< where it is
  float score = 0;  ///< probability that it is a face, 0 to 1
  /// By how much it is turned in the image, clockwise, radians; 0 from FaceDetector, which finds faces that are turned by up to
  /// about 30 degrees.
  float roll = 0;
};

/// Largest side of a frame that is searched, px.
constexpr int kLargestFramePx = 8192;

/// What a detector is made for. Fixes its memory.
struct FaceDetectorLimits {
  std::uint16_t width = 320, height = 240;  ///< largest frame, px, up to kLargestFramePx
  std::uint16_t smallest_px = 48;           ///< side of the smallest face box, px; less than 48 counts as 48
  /// Windows that one call keeps, the best ones, of which a face has 3 to 40: of more than about 50 faces in a frame the default
  /// loses some. 16 bytes each; 0 counts as 1.
  std::uint16_t hits = 192;
};

/// Finds upright faces, in frames whose pixels are about square, by a window that slides over the frame at many sizes, and boosted
/// trees over gradient cells (docs/algorithms.md, section 7.12), from a learnt table. Boxes have sides from `smallest_px` to 1.2
/// times the frame's smaller side, and may reach a quarter of their side beyond its border. Lives in an arena (create_in,
/// measured_bytes): 32 kB for a frame 320 px wide or more.
class FaceDetector {
 public:
  FaceDetector() = default;
  FaceDetector(const FaceDetector&) = delete;
  FaceDetector& operator=(const FaceDetector&) = delete;

  /// Takes its memory from the arena; called by create_in and measured_bytes (arena.hpp).
  /// \param table  bytes of the detector's learnt table, which must outlive the detector.
  void lay_out(Arena& arena, const Span<const std::uint8_t>& table, const FaceDetectorLimits& limits);
  /// `ok` if there is a table that can be used; `not_found` without a table; `misaligned`, `truncated`, `bad_magic`,
  /// `bad_checksum`, `bad_table` for what cannot be used. Searching returns the same.
  Status status() const { return status_; }

  /// Searches a whole frame, independently of earlier calls. Writes the faces found to `room`, best first, and their
  /// number to `count`: those with the highest scores if there are more than fit (FaceDetectorLimits::hits limits them, too).
  /// \return as status(); `bad_argument` for a null pointer or an unreadable frame, `size_mismatch` for one beyond the
  ///         limits. A frame too small for a face is `ok`; nothing is found. Cost: 4 ms on a PC for 320 x 240 pixels,
  ///         64 million instructions on a Cortex-M7.
  Status find(const FrameView& frame, Span<DetectedFace> room, std::size_t* count);

  /// Searches a part of a frame: goes on where the last call ended, at the same size of faces and a row further down, or
  /// from the largest size on, whose search takes least. `find` and another frame size begin again.
  /// \param work         cells to be searched, where find(320 x 240) searches 21,000; at least one row is searched.
  /// \param is_complete  set to true where the smallest size has been searched to its end; the search then stops, and the
  ///                     next call begins with the largest size.
  /// Faces found in this part are written as by `find`. \return as `find`.
  Status search(const FrameView& frame, std::uint32_t work, Span<DetectedFace> room, std::size_t* count,
                bool* is_complete);

  /// Searches around a box: boxes of 0.7 to 1.4 times its side whose middle is about a quarter of its side from its own,
  /// at most. A search in parts goes on afterwards where it was.
  /// \param face  the best one. \return not_found if there is none, `bad_argument` for a box without a side or far outside, else as
  ///              `find`. Cost: a twelfth of a `find` in 320 x 240 pixels.
  Status search_near(const FrameView& frame, const FaceBox& box, DetectedFace* face);

 private:
  struct State;
  Status check_input(const FrameView& frame, Span<DetectedFace> room, const std::size_t* count) const;

  FaceDetectorLimits limits_;
  State* state_ = nullptr;
  Status status_ = Status::not_found;
};

}  // namespace pliant
