#include "host/bench/detection_run.hpp"

namespace pliant::host {

namespace {

TrackerLimits limits_for(int width, int height) {
  TrackerLimits limits;
  limits.width = static_cast<std::uint16_t>(width);
  limits.height = static_cast<std::uint16_t>(height);
  return limits;
}

}  // namespace

DetectionRun::DetectionRun(const ModelFile& file, int width, int height)
    : DetectionRun(file, limits_for(width, height)) {}

void DetectionRun::update(const FrameView& frame) {
  require(tracker_->update(frame, &result_), "detection");
  is_started_ = tracker_->is_started();
}

NamedLandmarks DetectionRun::landmarks() {
  NamedLandmarks out;
  const auto landmarks = tracker_->model().landmarks();
  for (std::size_t k = 0; k < landmarks.count; ++k) {
    Vec2 x;
    if (tracker_->landmark(k, &x) == Status::ok) out[landmarks[k].name] = x;
  }
  return out;
}

}  // namespace pliant::host
