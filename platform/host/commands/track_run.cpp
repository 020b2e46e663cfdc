#include "host/commands/track_run.hpp"

#include <chrono>

#include "host/io/failure.hpp"

namespace pliant::host {

void TrackRun::start(const FrameView& frame, const Initial& initial, const InitialOptions& options) {
  require(start_tracker(tracker_, frame, initial, options, options_, markers_.x), where(frame));
  output_.add(frames_, frame, tracker_, 0);
}

void TrackRun::search(const FrameView& frame, const InitialOptions& options, const std::string& model) {
  const Status status = tracker_.start_by_detection(start_options(options), options_);
  if (status == Status::not_found)
    fail_input(model, "has no learnt tables to find a face with: give --init, or bake it with --learnt");
  require(status, model);
  track(frame);
}

void TrackRun::track(const FrameView& frame) {
  FrameResult result;
  const auto before = std::chrono::steady_clock::now();
  const Status status = tracker_.update(frame, &result);
  if (frames_.is_live() && status == Status::stale_frame)
    return;  // cameras deliver a frame twice now and then
  require(status, where(frame));
  const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - before;
  if (tracker_.is_started())
    output_.add(frames_, frame, tracker_, elapsed.count());
  else
    output_.add_lost(frames_, frame);
}

}  // namespace pliant::host
