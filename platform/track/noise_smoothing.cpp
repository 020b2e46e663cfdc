#include "track/noise_smoothing.hpp"

#include "face/ibug_landmarks.hpp"

namespace pliant {

bool is_smoothed(const Model& model) {
  std::uint16_t corners[4];
  return find_box_corners(model, corners);
}

namespace {

NoiseFilter* lay_out(Arena& arena, const Model& model, const TrackerLimits& limits) {
  arena.count_as(Purpose::pyramid);
  return is_smoothed(model) ? create_part<NoiseFilter>(arena, limits.width, limits.height) : nullptr;
}

const FrameView& smoothed(NoiseFilter& filter, const FrameView& frame) {
  return filter.smoothed(frame);
}

}  // namespace

const NoiseSmoothing kNoiseSmoothing{lay_out, smoothed};

}  // namespace pliant
