#pragma once
/// \file frame_source.hpp
/// Frames from a folder of pictures, a video file, a Y4M stream on standard input or a camera.
#include <cstdint>
#include <memory>
#include <string>

#include "host/io/image.hpp"
#include "pliant/frame.hpp"
#include "pliant/status.hpp"

namespace pliant::host {

/// Frames per second.
struct FrameRate {
  int numerator = 25, denominator = 1;
  double per_second() const { return static_cast<double>(numerator) / denominator; }
};

/// A sequence of luma frames of one size.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  FrameSource(const FrameSource&) = delete;
  FrameSource& operator=(const FrameSource&) = delete;

  /// Reads the next frame. The view is valid until the next call. Its sequence number counts from 0 and its time is
  /// sequence / rate; a camera sets both itself. Statuses: `end_of_stream` after the last frame, `truncated` if the data end
  /// within a frame, `size_mismatch` for a picture of another size, `io_error` for a failed read or malformed data,
  /// `camera_lost` for an unplugged camera. After any of them every call returns the same, and message() names the error.
  Status next(FrameView& frame);

  /// The last frame in colour; an empty picture if the source has no colour.
  virtual Image colour() const { return {}; }

  int width() const { return width_; }
  int height() const { return height_; }
  /// Frames per second that the stream states; 25 if it states none. A folder states none.
  FrameRate rate() const { return rate_; }
  /// Number of frames that are expected in all; 0: unknown. A file that is cut off has fewer.
  std::size_t count() const { return count_; }
  /// True for a camera: it sets times and numbers, has no end, and drops frames that are not read in time.
  bool is_live() const { return is_live_; }
  /// One line that names the file and the error; empty without an error.
  const std::string& message() const { return message_; }
  /// After the last frame one line about a file that was read in spite of damage; empty without any.
  const std::string& note() const { return note_; }

 protected:
  FrameSource() = default;
  /// Sets `frame.data` to the luma of frame number `index`. The other members are set for rows without padding and may be
  /// changed.
  virtual Status read(std::uint32_t index, FrameView& frame) = 0;
  Status fail(Status status, std::string message) {
    message_ = std::move(message);
    return status;
  }

  int width_ = 0, height_ = 0;
  FrameRate rate_;
  std::size_t count_ = 0;
  bool is_live_ = false;
  std::string note_;

 private:
  std::uint32_t index_ = 0;
  Status status_ = Status::ok;
  std::string message_;
};

/// A source, or the error.
struct OpenedFrames {
  std::unique_ptr<FrameSource> source;  ///< null on failure
  std::string message;                  ///< on failure one line that names the file and the error
};

/// "-": a Y4M stream on standard input; "camera:[ID or INDEX][@WxH]": a camera; a folder; a picture (one frame); a Y4M file;
/// any other file is read through the ffmpeg program, if that is installed.
OpenedFrames open_frames(const std::string& name);

/// Opens all PNG, JPEG and PNM pictures of a folder, ordered by name; digits compare as numbers (2 before 10).
OpenedFrames open_folder(const std::string& path);
/// Opens a Y4M file, or standard input for "-".
OpenedFrames open_y4m(const std::string& path);

}  // namespace pliant::host
