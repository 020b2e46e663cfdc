#include "host/commands/track_run.hpp"

#include <chrono>

#include "host/io/failure.hpp"

namespace pliant::host {

void TrackRun::start(const FrameView& frame, const Initial& initial, const InitialOptions& options) {
  require(start_tracker(tracker_, frame, initial, options, options_, markers_.x), where(frame));
  output_.add(frames_.number(frame), frames_.time_s(frame), frame, tracker_, 0);
}

void TrackRun::track(const FrameView& frame) {
  FrameResult result;
  const auto before = std::chrono::steady_clock::now();
  const Status status = tracker_.update(frame, &result);
  if (frames_.is_live() && status == Status::stale_frame)
    return;  // cameras deliver a frame twice now and then
  require(status, where(frame));
  const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - before;
  output_.add(frames_.number(frame), frames_.time_s(frame), frame, tracker_, elapsed.count());
}

}  // namespace pliant::host
