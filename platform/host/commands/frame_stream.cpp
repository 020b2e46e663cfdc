#include "host/commands/frame_stream.hpp"

#include <algorithm>

#include "host/io/failure.hpp"
#include "host/render/overlay.hpp"

namespace pliant::host {

FrameStream::FrameStream(const std::string& name, bool is_mirrored) : name_(name), is_mirrored_(is_mirrored) {
  OpenedFrames opened = open_frames(name);
  if (opened.source == nullptr) throw Failure(kBadInput, opened.message);
  source_ = std::move(opened.source);
}

bool FrameStream::next(FrameView* frame) {
  if (source_->next(*frame) != Status::ok) return false;
  if (is_mirrored_) mirror(frame);
  if (!first_) first_ = *frame;
  return true;
}

double FrameStream::time_s(const FrameView& frame) const {
  if (is_live()) return 1e-9 * static_cast<double>(frame.time_ns - first_->time_ns);
  return static_cast<double>(number(frame)) / rate().per_second();
}

void FrameStream::mirror(FrameView* frame) {
  mirrored_ = image_of(*frame);
  for (int y = 0; y < mirrored_.height; ++y)
    std::reverse(mirrored_.at(0, y), mirrored_.at(0, y) + mirrored_.width);
  frame->data = mirrored_.pixels.data();
  frame->stride_bytes = static_cast<std::size_t>(mirrored_.width);
  frame->pixel_step_bytes = 1;
}

}  // namespace pliant::host
