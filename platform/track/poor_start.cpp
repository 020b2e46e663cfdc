#include "track/poor_start.hpp"

namespace pliant {

namespace {

constexpr const PoorStartTuning& kTuning = kPoorStartTuning;

/// The pixels at the landmarks.
struct Light {
  float grey = -1;    // mean, grey levels; negative: no landmark is in the frame
  float clipped = 0;  // fraction that is as bright as a pixel can be
};

Light light_on(const FrameView& frame, Estimator& estimator) {
  const auto landmarks = estimator.model().landmarks();
  int sum = 0, count = 0, bright = 0;
  for (std::size_t k = 0; k < landmarks.count; k += kTuning.landmark_step) {
    Vec2 x;
    if (!estimator.project(landmarks[k].uv(), &x)) continue;
    if (!(x.x >= 0 && x.x < static_cast<float>(frame.width) && x.y >= 0 &&
          x.y < static_cast<float>(frame.height)))
      continue;
    const auto column = static_cast<std::size_t>(x.x), row = static_cast<std::size_t>(x.y);
    const int grey =
        frame.data[row * frame.stride_bytes + column * static_cast<std::size_t>(frame.pixel_step_bytes)];
    sum += grey;
    bright += grey >= kTuning.clipped_grey;
    ++count;
  }
  if (count == 0) return {};
  const float each = 1.0f / static_cast<float>(count);
  return {each * static_cast<float>(sum), each * static_cast<float>(bright)};
}

}  // namespace

void PoorStart::begin(std::size_t captured, std::size_t most, const FrameView& frame, Estimator& estimator) {
  const bool is_poor = static_cast<float>(captured) < kTuning.few_templates * static_cast<float>(most);
  const Light light = is_poor ? light_on(frame, estimator) : Light{};
  start_grey_ = light.grey;
  clipped_ = light.clipped;
  frames_ = 0;
  changed_count_ = 0;
}

bool PoorStart::is_over(const FrameView& frame, Estimator& estimator) {
  if (start_grey_ < 0 || ++frames_ % kTuning.interval_frames != 0) return false;
  const Light now = light_on(frame, estimator);
  if (now.grey < 0) return false;
  const float low = min(now.grey, start_grey_) + kTuning.dark_grey,
              high = max(now.grey, start_grey_) + kTuning.dark_grey;
  // What is clipped is darker than it should be: the mean of such a face falls less than the light does.
  const bool shows_more = is_blinded() && now.clipped <= kTuning.clipped_ratio * clipped_;
  if (high > kTuning.light_ratio * low || shows_more)
    ++changed_count_;
  else if (!is_blinded())
    changed_count_ = 0;
  return changed_count_ >= kTuning.measurements;
}

}  // namespace pliant
