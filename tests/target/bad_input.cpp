// What a camera, a table or an arena can be, and must not be: each has a status, the same on every target, and none
// disturbs the track: the frame after them gives the bits that it gives without them.
#include <cstring>

#include "board.h"
#include "camera_buffers.hpp"
#include "film.hpp"
#include "line.hpp"
#include "pliant/tracker.hpp"
#include "start.hpp"

extern const unsigned char face[];
extern const std::size_t face_bytes;

using namespace pliant;

namespace {

constexpr int kWidth = 320, kHeight = 240, kPaddedStride = 352;
constexpr std::size_t kArenaBytes = 249 * 1024;

constexpr TrackerLimits kLimits = without_detection(profile_s());  // an update before a start is refused

alignas(Arena::kAlignment) unsigned char memory[kArenaBytes];
[[gnu::section(".frames")]] std::uint8_t frames[3][kWidth * kHeight];
[[gnu::section(".frames")]] std::uint8_t padded[kHeight * kPaddedStride];
Tracker tracker;
int failures = 0;

void check(const char* what, Status status, Status expected) {
  const bool is_right = status == expected;
  failures += !is_right;
  Line line;
  line.add("case ").add(what).add(": ").add(text(status)).add(is_right ? "\n" : ", WRONG\n");
  board_write(line.text());
}

void check(const char* what, bool is_right) {
  failures += !is_right;
  board_write(Line().add("case ").add(what).add(is_right ? ": yes\n" : ": NO\n").text());
}

FrameView view_of_frame(int k) {
  return {frames[k],
          kWidth,
          kHeight,
          kWidth,
          1,
          (k + 10) * std::int64_t{33'333'333},
          static_cast<std::uint32_t>(k + 10)};
}

Status start(const FrameView& frame) {
  return tracker.start_from_pose(frame, kStartCamera, kStartPose, kStartParameters);
}

void tables(Model& model) {
  check("table at an odd address", Model::open(face + 1, face_bytes - 1, &model), Status::misaligned);
  check("table at an even address that is no multiple of four", Model::open(face + 2, face_bytes - 2, &model),
        Status::misaligned);
  check("no table", Model::open(nullptr, face_bytes, &model), Status::bad_argument);
  check("table a byte short", Model::open(face, face_bytes - 1, &model), Status::truncated);
  check("table of eight bytes", Model::open(face, 8, &model), Status::truncated);
  check("another table", Model::open(face + 4, face_bytes - 4, &model), Status::bad_magic);
  check("the table", Model::open(face, face_bytes, &model), Status::ok);
}

void arenas(const Model& model) {
  Arena measuring;  // not by measured_bytes, which makes a tracker on the stack
  tracker.lay_out(measuring, model, kLimits);
  const std::size_t bytes = measuring.used_bytes();
  Arena small(memory, bytes - 1);
  check("arena a byte short", create_in(small, tracker, model, kLimits), Status::out_of_memory);
  check("nothing was taken from it", small.used_bytes() == 0);
  Arena empty(memory, 0);
  check("arena of nothing", create_in(empty, tracker, model, kLimits), Status::out_of_memory);
  Arena arena(memory, bytes);
  check("arena of just its size", create_in(arena, tracker, model, kLimits), Status::ok);
}

/// What profile L takes here, for the table of sizes.
void print_large(const Model& model) {
  Arena measuring;
  tracker.lay_out(measuring, model, profile_l());
  board_write(Line().add("sizes: arena ").add(static_cast<int>(measuring.used_bytes())).add("\n").text());
}

void starts() {
  FrameResult result;
  check("update before start", tracker.update(view_of_frame(0), &result), Status::not_started);
  check("start without a frame", start({}), Status::bad_argument);
  FrameView frame = view_of_frame(0);
  frame.width = kWidth - 1;
  check("start with a frame of another size", start(frame), Status::size_mismatch);
  const Status status = tracker.start_from_pose(view_of_frame(0), kStartCamera, {{}, {0, 0, 0}}, kStartParameters);
  check("start at the camera's own place", status, Status::bad_argument);
  check("start", start(view_of_frame(0)), Status::ok);
}

/// Frames that are refused, between the first and the second good one.
void refused_frames() {
  FrameResult result;
  const auto update = [&result](const FrameView& frame) { return tracker.update(frame, &result); };
  check("the same frame twice", update(view_of_frame(0)), Status::stale_frame);
  FrameView frame = view_of_frame(1);
  frame.time_ns = 5;
  frame.sequence = 9;
  check("a frame that arrives too late", update(frame), Status::stale_frame);
  frame = view_of_frame(1);
  frame.data = nullptr;
  check("a null pointer", update(frame), Status::bad_argument);
  frame = view_of_frame(1);
  frame.stride_bytes = kWidth - 1;
  check("a stride shorter than a row", update(frame), Status::bad_argument);
  frame = view_of_frame(1);
  frame.pixel_step_bytes = 3;
  check("a step of three bytes", update(frame), Status::bad_argument);
  frame = view_of_frame(1);
  frame.height = 0;
  check("a frame without rows", update(frame), Status::bad_argument);
  frame.height = kHeight + 1;
  check("a frame of another size", update(frame), Status::size_mismatch);
  check("nowhere to put the result", tracker.update(view_of_frame(1), nullptr), Status::bad_argument);
}

bool same_bits(const Pose& a, const Pose& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

/// The pose of frames 1 and 2 after a start, with or without bad frames, and with rows of another length.
bool run(bool with_bad_frames, bool with_padding, Pose* poses) {
  if (start(view_of_frame(0)) != Status::ok) return false;
  if (with_bad_frames) refused_frames();
  for (int k = 1; k < 3; ++k) {
    FrameView frame = view_of_frame(k);
    if (with_padding) {
      for (int y = 0; y < kHeight; ++y)
        std::memcpy(padded + y * kPaddedStride, frames[k] + y * kWidth, kWidth);
      frame.data = padded;
      frame.stride_bytes = kPaddedStride;
    }
    FrameResult result;
    if (tracker.update(frame, &result) != Status::ok) return false;
    poses[k - 1] = result.pose;
  }
  return true;
}

bool read_frames() {
  CameraBuffers buffers(padded, padded, kWidth, kHeight,
                        kWidth);  // one will do: each frame is copied before the next
  Film film(buffers, kWidth, kHeight, 1);
  if (!film.open("frames.y4m")) return false;
  for (auto& each : frames) {
    FrameView frame;
    if (!film.expose() || !buffers.take(&frame)) return false;
    std::memcpy(each, frame.data, sizeof each);
    buffers.give_back();
  }
  return true;
}

void camera_buffers() {
  CameraBuffers buffers(frames[0], frames[1], kWidth, kHeight, kWidth);
  FrameView first, next;
  check("no frame before the camera's first", !buffers.take(&first));
  buffers.on_frame_complete(1);
  const bool has_first = buffers.take(&first);
  buffers.on_frame_complete(2);
  buffers.on_frame_complete(3);
  check("frames are dropped and counted while one is held, which stays", has_first && first.data == frames[0] &&
                                                                             buffers.filling() == frames[1] &&
                                                                             buffers.dropped() == 2);
  buffers.give_back();
  buffers.on_frame_complete(4);
  check("the frame after them has its own number and time", buffers.take(&next) && next.data == frames[1] &&
                                                               next.sequence == 4 && next.time_ns == 4 &&
                                                               buffers.dropped() == 2);
}

}  // namespace

int main() {
  if (!read_frames()) {
    board_write("no frames.y4m here\n");
    return 1;
  }
  Model model;
  tables(model);
  print_large(model);
  arenas(model);
  starts();
  camera_buffers();
  Pose plain[2], disturbed[2], strided[2];
  check("three runs", run(false, false, plain) && run(true, false, disturbed) && run(false, true, strided));
  check("refused frames leave the track as it was, to the bit",
        same_bits(plain[0], disturbed[0]) && same_bits(plain[1], disturbed[1]));
  check("another stride gives the same bits",
        same_bits(plain[0], strided[0]) && same_bits(plain[1], strided[1]));
  return failures == 0 ? 0 : 1;
}
