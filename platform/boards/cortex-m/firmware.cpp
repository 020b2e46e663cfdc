// The example in C++: tracks a face on a microcontroller. The model table is in flash. The memory of the tracker is one
// static block. A camera's DMA delivers the frames. Prints the pose of every frame, and instructions and stack at the
// end. With PLIANT_FIRMWARE_DETECTS the tracker finds the face by itself; without, the first pose is known.
#include <cstring>

#include "board.h"
#include "camera_buffers.hpp"
#include "film.hpp"
#include "line.hpp"
#include "pliant/pliant.hpp"
#include "start.hpp"  // the pose in the first frame

extern const unsigned char face[];
extern const std::size_t face_bytes;

namespace {

constexpr int kWidth = 320, kHeight = 240;
constexpr std::int64_t kFrameNs = 33'333'333;


#ifdef PLIANT_FIRMWARE_DETECTS
constexpr bool kDetects = true;
constexpr std::size_t kArenaBytes = 249 * 1024;
// The search for printed surfaces is not linked.
constexpr pliant::TrackerLimits kLimits =
    pliant::with_detection(pliant::profile_s(), pliant::kUprightFaceDetection);
#else
constexpr bool kDetects = false;  // its code is not linked
constexpr std::size_t kArenaBytes = 231 * 1024;
constexpr pliant::TrackerLimits kLimits = pliant::without_detection(pliant::profile_s());
#endif

alignas(pliant::Arena::kAlignment) unsigned char memory[kArenaBytes];
[[gnu::section(".frames")]] alignas(32) std::uint8_t frames[2][kWidth * kHeight];
pliant::Tracker tracker;

/// FNV-1a of the result of a frame: two runs that print the same hash agree in every bit.
std::uint32_t hash_of(const pliant::Estimator& estimator, const pliant::FrameResult& result) {
  std::uint32_t hash = 2166136261u;
  const auto add = [&hash](float x) {
    std::uint32_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    for (int k = 0; k < 4; ++k) hash = (hash ^ ((bits >> (8 * k)) & 255u)) * 16777619u;
  };
  const pliant::Pose& p = result.pose;
  const float pose[] = {
      p.q.w, p.q.x, p.q.y, p.q.z, p.t.x, p.t.y, p.t.z, result.rms_px, static_cast<float>(result.inliers)};
  for (float x : pose) add(x);
  if (!estimator.is_started()) return hash;
  for (float x : estimator.parameters()) add(x);
  for (pliant::VertexId v : estimator.mesh().vertices()) {
    add(estimator.vertex_images()[v].x);
    add(estimator.vertex_images()[v].y);
  }
  return hash;
}

void print(int frame, const pliant::FrameResult& r, std::uint32_t hash) {
  Line line;
  line.add("frame ").add(frame).add(" state ").add(static_cast<int>(r.state)).add(" q");
  line.add(" ").add(r.pose.q.w).add(" ").add(r.pose.q.x).add(" ").add(r.pose.q.y).add(" ").add(r.pose.q.z);
  line.add(" t ").add(r.pose.t.x).add(" ").add(r.pose.t.y).add(" ").add(r.pose.t.z);
  line.add(" inliers ").add(int{r.inliers}).add(" bits ").add_hex(hash).add("\n");
  board_write(line.text());
}

/// Ends the program with the status's text when it is not ok.
void require(pliant::Status status, const char* what) {
  if (status == pliant::Status::ok) return;
  board_write(Line().add(what).add(": ").add(pliant::text(status)).add("\n").text());
  board_exit(1);
}

/// Makes the tracker. It keeps what it needs of the Model object; the table must stay.
void set_up() {
  pliant::Model model;
  require(pliant::Model::open(face, face_bytes, &model), "model");
  pliant::Arena arena(memory, sizeof memory);
  require(pliant::create_in(arena, tracker, model, kLimits), "arena");
  Line line;
  line.add("sizes: object ").add(static_cast<int>(sizeof tracker));
  line.add(", arena ").add(static_cast<int>(arena.used_bytes())).add("\n");
  board_write(line.text());
}

struct Cost {
  std::uint32_t worst = 0, sum = 0;  // ticks
  int frames = 0;
  void add(std::uint32_t ticks) {
    if (ticks > worst) worst = ticks;
    sum += ticks;
    ++frames;
  }
  void print(const char* what) const {
    if (frames == 0 || worst == 0) return;
    const auto thousands = [](std::uint32_t t) {
      return static_cast<int>(t / (1000 / BOARD_INSTRUCTIONS_PER_TICK));
    };
    Line line;
    line.add("thousand instructions a ").add(what).add(": mean ").add(thousands(sum / static_cast<std::uint32_t>(frames)));
    board_write(line.add(", worst ").add(thousands(worst)).add("\n").text());
  }
};

}  // namespace

int main() {
  set_up();
  CameraBuffers buffers(frames[0], frames[1], kWidth, kHeight, kWidth);
  Film film(buffers, kWidth, kHeight, kFrameNs);
  if (!film.open("frames.y4m")) {
    board_write("no frames.y4m here\n");
    return 1;
  }
  int frame = 0, tracked = 0;
  Cost tracking, search;
  for (; film.expose(); ++frame) {
    pliant::FrameView view;
    if (!buffers.take(&view)) continue;
    pliant::FrameResult result;
    const bool was_tracked = tracker.is_started();
    const std::uint32_t begin = board_ticks();
    if (frame == 0 && !kDetects) {
      require(tracker.start_from_pose(view, kStartCamera, kStartPose, kStartParameters), "start");
      result = tracker.result();
    } else {
      require(tracker.update(view, &result), "update");
      const std::uint32_t ticks = (board_ticks() - begin) & BOARD_TICK_MASK;
      (was_tracked ? tracking : search).add(ticks);
    }
    buffers.give_back();
    tracked += result.state == pliant::TrackState::tracking;
    print(frame, result, hash_of(tracker.estimator(), result));
  }
  tracking.print("frame");
  search.print("frame of the search and the start");
  if (board_stack_bytes() > 0) {
    Line line;
    line.add("stack ").add(static_cast<int>(board_worst_stack_bytes())).add(" of ");
    board_write(line.add(static_cast<int>(board_stack_bytes())).add(" bytes\n").text());
  }
  const bool is_tracked = kDetects ? 2 * tracked > frame : tracked == frame;
  return frame > 1 && is_tracked && board_worst_stack_bytes() <= board_stack_bytes() ? 0 : 1;
}
