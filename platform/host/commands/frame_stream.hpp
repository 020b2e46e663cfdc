#pragma once
/// \file frame_stream.hpp
/// The frames of a video, a folder or a camera, in their order, mirrored if asked for.
#include <memory>
#include <optional>
#include <string>

#include "host/commands/args.hpp"
#include "host/io/frame_source.hpp"
#include "host/io/image.hpp"
#include "pliant/frame.hpp"

namespace pliant::host {

class FrameStream {
 public:
  /// \param name  as `--frames` takes it. Bad input: it cannot be opened.
  FrameStream(const std::string& name, bool is_mirrored);

  const std::string& name() const { return name_; }
  ImageSize size() const { return {source_->width(), source_->height()}; }
  FrameRate rate() const { return source_->rate(); }
  /// Number of frames that are expected in all; 0: unknown.
  std::size_t count() const { return source_->count(); }
  bool is_live() const { return source_->is_live(); }
  /// Why `next` gave no frame; empty at the regular end.
  const std::string& message() const { return source_->message(); }
  /// As FrameSource::note.
  const std::string& note() const { return source_->note(); }

  /// The next frame, valid until the call after it. False at the end.
  bool next(FrameView* frame);
  /// The last frame as a picture: in colour if the source has colour, and mirrored as the frame is.
  Image picture(const FrameView& frame) const;
  /// Number of a frame; the first is 0. A camera's dropped frames leave gaps.
  std::size_t number(const FrameView& frame) const { return frame.sequence - first_->sequence; }
  /// Time of a frame since the first, s: by a camera's clock, else by the frame rate.
  double time_s(const FrameView& frame) const;

 private:
  static Image mirrored(const Image& image);

  std::string name_;
  bool is_mirrored_;
  std::unique_ptr<FrameSource> source_;
  std::optional<FrameView> first_;
  Image mirrored_;
};

}  // namespace pliant::host
