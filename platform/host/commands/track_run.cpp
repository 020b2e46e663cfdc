#include "host/commands/track_run.hpp"

#include <chrono>

#include "host/io/failure.hpp"

namespace pliant::host {

Status TrackRun::start_tracking(const FrameView& frame, const Initial& initial,
                                const InitialOptions& options) {
  const Status status = start_tracker(tracker_, frame, initial, options, options_, markers_.x);
  if (status != Status::ok) return status;
  is_tracking_ = true;
  focal_px_ = tracker_.camera().f;
  output_.add(frames_.number(frame), frames_.time_s(frame), frame, tracker_, 0);
  return status;
}

void TrackRun::start(const FrameView& frame, const Initial& initial, const InitialOptions& options) {
  require(start_tracking(frame, initial, options), where(frame));
}

void TrackRun::take(const FrameView& frame) {
  if (is_tracking_)
    track(frame);
  else
    search(frame);
}

void TrackRun::search(const FrameView& frame) {
  const std::size_t number = frames_.number(frame);
  const auto found = detection_->find(frame, number);
  if (found && start_tracking(frame, *found, {}) == Status::ok) return;
  if (found) detection_->reject(number);
  output_.add_lost(number, frames_.time_s(frame), frame);
}

void TrackRun::track(const FrameView& frame) {
  FrameResult result;
  const auto before = std::chrono::steady_clock::now();
  const Status status = tracker_.update(frame, &result);
  if (frames_.is_live() && status == Status::stale_frame)
    return;  // cameras deliver a frame twice now and then
  require(status, where(frame));
  const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - before;
  const std::size_t number = frames_.number(frame);
  is_tracking_ = detection_ == nullptr || detection_->is_confirmed(frame, number, tracker_);
  if (is_tracking_)
    output_.add(number, frames_.time_s(frame), frame, tracker_, elapsed.count());
  else
    output_.add_lost(number, frames_.time_s(frame), frame);
}

}  // namespace pliant::host
