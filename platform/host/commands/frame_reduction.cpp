#include "host/commands/frame_reduction.hpp"

#include <algorithm>
#include <cmath>

namespace pliant::host {

namespace {

/// Tuning of the reduction. Each constant: unit, reason, experiment.
struct FrameReductionTuning {
  /// Scale up to which a face is tracked in the frames as they are, px a mm: 400 px between the outer corners of the eyes. A
  /// template has 11 px a side, and at a larger scale too little on it. Chosen on the recorded face (docs/experiments.md,
  /// Enlarged).
  float most_px_per_mm = 4.4f;
  /// Larger side of frames in which a face is found whatever its size, px: one that fills them has 4.4 px a mm.
  int overview_side = 1280;
  /// Smaller side that reduced frames have at least, px: that of the smallest frames a track is measured with. Not tuned.
  int least_side = 240;
};
constexpr FrameReductionTuning kTuning{};

int most_factor(ImageSize size) {
  return std::max(1, std::min(size.width, size.height) / kTuning.least_side);
}

}  // namespace

int FrameReduction::factor_for(float px_per_mm, ImageSize size) {
  // A start from points far outside of the frame may say anything.
  return static_cast<int>(
      clamp(std::ceil(px_per_mm / kTuning.most_px_per_mm), 1, static_cast<float>(most_factor(size))));
}

int FrameReduction::factor_for(ImageSize size) {
  const int wanted = (std::max(size.width, size.height) + kTuning.overview_side - 1) / kTuning.overview_side;
  return std::min(wanted, most_factor(size));
}

FrameView FrameReduction::reduced(const FrameView& frame) {
  if (factor_ == 1) return frame;
  const ImageSize size = reduced(ImageSize{frame.width, frame.height});
  image_ = Image(size.width, size.height, 1);
  const auto step = static_cast<std::size_t>(frame.pixel_step_bytes);
  const int count = factor_ * factor_;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      int sum = count / 2;
      for (int j = 0; j < factor_; ++j) {
        const auto* row = frame.data + static_cast<std::size_t>(y * factor_ + j) * frame.stride_bytes;
        for (int i = 0; i < factor_; ++i) sum += row[static_cast<std::size_t>(x * factor_ + i) * step];
      }
      *image_.at(x, y) = static_cast<std::uint8_t>(sum / count);
    }
  FrameView out = frame;
  out.data = image_.pixels.data();
  out.width = size.width;
  out.height = size.height;
  out.stride_bytes = static_cast<std::size_t>(size.width);
  out.pixel_step_bytes = 1;
  return out;
}

Camera FrameReduction::reduced(const Camera& camera) const {
  Camera out = camera;
  out.f /= static_cast<float>(factor_);
  const Vec2 c = reduced(Vec2{camera.cx, camera.cy});
  out.cx = c.x;
  out.cy = c.y;
  return out;
}

Vec2 FrameReduction::reduced(Vec2 x) const {
  if (factor_ == 1) return x;  // not a bit else than the caller says
  const float scale = 1 / static_cast<float>(factor_);
  return {(x.x + 0.5f) * scale - 0.5f, (x.y + 0.5f) * scale - 0.5f};
}

Vec2 FrameReduction::whole(Vec2 x) const {
  if (factor_ == 1) return x;  // not a bit else than the tracker says
  const auto scale = static_cast<float>(factor_);
  return {(x.x + 0.5f) * scale - 0.5f, (x.y + 0.5f) * scale - 0.5f};
}

}  // namespace pliant::host
