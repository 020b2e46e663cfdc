// The README's example: follows a face through frames that somebody hands over.
#include <cstdint>
#include <cstdio>

#include "pliant/tracker.hpp"

namespace {
alignas(pliant::Arena::kAlignment) unsigned char memory[4 << 20];
pliant::Tracker tracker;
}  // namespace

/// Called once, with the table that `pliant bake` wrote and a start that `pliant fit` found.
pliant::Status start(const void* table, std::size_t bytes, const pliant::FrameView& frame,
                     const pliant::Camera& camera, const pliant::Pose& pose, const float* q) {
  pliant::Model model;
  pliant::Status status = pliant::Model::open(table, bytes, &model);
  if (status != pliant::Status::ok) return status;
  pliant::TrackerLimits limits;  // 320 x 240, 128 patches, 512 vertices
  pliant::Arena arena(memory, sizeof memory);
  status = pliant::create_in(arena, tracker, model, limits);
  if (status != pliant::Status::ok) return status;
  return tracker.start_from_pose(frame, camera, pose, q);
}

/// Called for every frame after that.
void on_frame(const pliant::FrameView& frame) {
  pliant::FrameResult result;
  if (tracker.update(frame, &result) != pliant::Status::ok) return;
  if (result.state == pliant::TrackState::tracking)
    std::printf("%f %f %f\n", double(result.pose.t.x), double(result.pose.t.y), double(result.pose.t.z));
}

int main() {
  // No table here: the point is that it compiles, links and answers.
  const std::uint32_t nonsense[16] = {1, 2, 3};
  const pliant::Status status = start(nonsense, sizeof nonsense, {}, {}, {}, nullptr);
  on_frame({});
  std::printf("pliant %d.%d: %s\n", PLIANT_VERSION_MAJOR, PLIANT_VERSION_MINOR, pliant::text(status));
  return status == pliant::Status::bad_magic ? 0 : 1;
}
