#include "track/poor_start.hpp"

namespace pliant {

namespace {

constexpr const PoorStartTuning& kTuning = kPoorStartTuning;

/// Mean of the pixels at the landmarks, grey levels; negative if none is in the frame. \param clipped  out: how many of them are
/// as bright as a pixel can be, as a fraction; null: not asked for.
float mean_grey(const FrameView& frame, Estimator& estimator, float* clipped = nullptr) {
  const auto landmarks = estimator.model().landmarks();
  float sum = 0;
  int count = 0, bright = 0;
  for (std::size_t k = 0; k < landmarks.count; k += kTuning.landmark_step) {
    Vec2 x;
    if (!estimator.project({landmarks[k].u, landmarks[k].v}, &x)) continue;
    if (!(x.x >= 0 && x.x < static_cast<float>(frame.width) && x.y >= 0 &&
          x.y < static_cast<float>(frame.height)))
      continue;
    const auto column = static_cast<std::size_t>(x.x), row = static_cast<std::size_t>(x.y);
    const std::uint8_t grey =
        frame.data[row * frame.stride_bytes + column * static_cast<std::size_t>(frame.pixel_step_bytes)];
    sum += grey;
    bright += grey >= kTuning.clipped_grey;
    ++count;
  }
  if (clipped != nullptr) *clipped = count > 0 ? static_cast<float>(bright) / static_cast<float>(count) : 0;
  return count > 0 ? sum / static_cast<float>(count) : -1;
}

}  // namespace

void PoorStart::begin(std::size_t captured, std::size_t most, const FrameView& frame, Estimator& estimator) {
  const bool is_poor = static_cast<float>(captured) < kTuning.few_templates * static_cast<float>(most);
  clipped_ = 0;
  start_grey_ = is_poor ? mean_grey(frame, estimator, &clipped_) : -1;
  frames_ = changed_count_ = 0;
}

bool PoorStart::is_over(const FrameView& frame, Estimator& estimator) {
  if (start_grey_ < 0 || ++frames_ % kTuning.interval_frames != 0) return false;
  const float now = mean_grey(frame, estimator);
  const float low = min(now, start_grey_) + kTuning.dark_grey,
              high = max(now, start_grey_) + kTuning.dark_grey;
  changed_count_ = now >= 0 && high > kTuning.light_ratio * low ? changed_count_ + 1 : 0;
  return changed_count_ >= kTuning.measurements;
}

}  // namespace pliant
