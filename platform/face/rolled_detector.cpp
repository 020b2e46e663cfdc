#include "face/rolled_detector.hpp"

#include "base/integers.hpp"

namespace pliant {

void RolledDetector::lay_out(Arena& arena, const Span<const std::uint8_t>& table,
                             const FaceDetectorLimits& limits, const Quat& expected, float aspect) {
  FaceDetectorLimits of_turned = limits;
  of_turned.width = of_turned.height =
      static_cast<std::uint16_t>(larger(int{limits.width}, int{limits.height}));
  FaceDetector::lay_out(arena, table, of_turned);
  picture_.lay_out(arena, limits.width, limits.height);
  expected_ = turn_of(expected);
  aspect_ = max(aspect, 1 / aspect) > kTuning.least_unlike ? aspect : 1;
}

/// Of the search that begins. Small turns, then quarters, come first.
int RolledDetector::next_turn() {
  static constexpr int kOthers[kTurnsOfPicture - 1] = {1, 7, 2, 6, 4, 3, 5};  // from the expected one
  const int round = searches_ / kTuning.period;
  const bool is_last = searches_ % kTuning.period == kTuning.period - 1;
  searches_ = (searches_ + 1) % (kTuning.period * (kTurnsOfPicture - 1));
  return is_last ? (expected_ + kOthers[round]) % kTurnsOfPicture : expected_;
}

const FrameView& RolledDetector::turned(const FrameView& frame, int turn) {
  if (!draws(turn) || frame.width < 2 || frame.height < 2) return frame;
  picture_.draw(frame, turn, aspect_);
  return picture_.view();
}

void RolledDetector::to_frame(int turn, Span<DetectedFace> faces) const {
  if (!draws(turn)) return;
  for (DetectedFace& face : faces) {
    face.box = picture_.to_frame(face.box);
    face.roll = roll_of_turn(turn);
  }
}

Status RolledDetector::find_at(int turn, const FrameView& frame, Span<DetectedFace> room,
                               std::size_t* count) {
  const Status status = FaceDetector::find(turned(frame, turn), room, count);
  if (status == Status::ok) to_frame(turn, {room.data, *count});
  return status;
}

Status RolledDetector::search(const FrameView& frame, std::uint32_t work, Span<DetectedFace> room,
                              std::size_t* count, bool* is_complete) {
  if (is_complete_) turn_ = next_turn();
  const Status status = FaceDetector::search(turned(frame, turn_), work, room, count, is_complete);
  is_complete_ = status != Status::ok || *is_complete;
  if (status == Status::ok) to_frame(turn_, {room.data, *count});
  return status;
}

Status RolledDetector::search_near(const FrameView& frame, const FaceBox& box, DetectedFace* face) {
  const int turn = face->score > 0 ? turn_of(exp_rotation({0, 0, face->roll})) : expected_;
  const FrameView& view = turned(frame, turn);
  const Status status = FaceDetector::search_near(view, draws(turn) ? picture_.from_frame(box) : box, face);
  if (status == Status::ok) to_frame(turn, {face, 1});
  return status;
}

}  // namespace pliant
