#include "track/frame_region.hpp"

#include "track/tracker_sizes.hpp"

namespace pliant {

namespace {

constexpr std::size_t kLongestRow = 1u << 24;  // bytes, of a frame that is used in place: offsets are 32 bits

/// First pixel of a window of `size` around `centre` inside 0 .. all, on the grid of the coarsest pyramid level.
int placed(float centre, int size, int all, int grid) {
  const float first = centre - 0.5f * static_cast<float>(size);
  const int at = static_cast<int>(clamp(first, 0, static_cast<float>(all - size)));
  return at / grid * grid;
}

PyramidLimits pyramid_limits(const TrackerLimits& limits) {
  PyramidLimits p;
  p.width = region_width(limits);
  p.height = region_height(limits);
  p.levels = limits.pyramid_levels;
  p.copies_frame = limits.copies_frame || limits.keeps_previous;
  return p;
}

}  // namespace

void FrameRegion::lay_out(Arena& arena, const TrackerLimits& limits) {
  frame_width_ = limits.width;
  frame_height_ = limits.height;
  width_ = region_width(limits);
  height_ = region_height(limits);
  grid_ = 1 << (limits.pyramid_levels - 1);
  keeps_previous_ = limits.keeps_previous;
  copies_frame_ = limits.copies_frame || limits.keeps_previous;
  arena.count_as(Purpose::pyramid);
  current_.lay_out(arena, pyramid_limits(limits));
  if (keeps_previous_) previous_.lay_out(arena, pyramid_limits(limits));
}

Status FrameRegion::check_frame(const FrameView& frame) const {
  const Status status = check(frame);
  if (status != Status::ok) return status;
  if (frame.width != frame_width_ || frame.height != frame_height_) return Status::size_mismatch;
  const bool is_usable = copies_frame_ || (frame.pixel_step_bytes == 1 && frame.stride_bytes <= kLongestRow);
  return is_usable ? Status::ok : Status::bad_argument;
}

void FrameRegion::advance() {
  if (!keeps_previous_) return;
  current_.swap(previous_);
  previous_origin_ = origin_;
}

Status FrameRegion::build(const FrameView& frame, Vec2 centre) {
  PLIANT_ASSERT(frame.width == frame_width_ && frame.height == frame_height_);
  int x = 0, y = 0;
  if (!is_whole_frame()) {
    x = placed(centre.x, width_, frame.width, grid_);
    y = placed(centre.y, height_, frame.height, grid_);
  }
  FrameView part = frame;
  part.width = width_;
  part.height = height_;
  part.data += static_cast<std::size_t>(y) * frame.stride_bytes +
               static_cast<std::size_t>(x) * static_cast<std::size_t>(frame.pixel_step_bytes);
  const Status status = current_.build(part);
  if (status == Status::ok) origin_ = {static_cast<float>(x), static_cast<float>(y)};
  return status;
}

bool FrameRegion::contains(Vec2 x) const {
  const Vec2 at = x - origin_;
  return at.x >= 0 && at.y >= 0 && at.x <= static_cast<float>(width_ - 1) &&
         at.y <= static_cast<float>(height_ - 1);
}

PixelBox FrameRegion::box() const {
  const int x = static_cast<int>(origin_.x), y = static_cast<int>(origin_.y);
  return {x, y, x + width_, y + height_};
}

}  // namespace pliant
