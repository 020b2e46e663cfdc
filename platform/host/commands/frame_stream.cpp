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
  if (is_mirrored_) {
    mirrored_ = mirrored(image_of(*frame));
    frame->data = mirrored_.pixels.data();
    frame->stride_bytes = static_cast<std::size_t>(mirrored_.width);
    frame->pixel_step_bytes = 1;
  }
  if (!first_) first_ = *frame;
  return true;
}

double FrameStream::time_s(const FrameView& frame) const {
  if (is_live()) return 1e-9 * static_cast<double>(frame.time_ns - first_->time_ns);
  return static_cast<double>(number(frame)) / rate().per_second();
}

Image FrameStream::picture(const FrameView& frame) const {
  const Image colour = source_->colour();
  if (colour.pixels.empty()) return image_of(frame);
  return is_mirrored_ ? mirrored(colour) : colour;
}

Image FrameStream::mirrored(const Image& image) {
  Image out = image;
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      std::copy_n(image.at(out.width - 1 - x, y), out.channels, out.at(x, y));
  return out;
}

}  // namespace pliant::host
