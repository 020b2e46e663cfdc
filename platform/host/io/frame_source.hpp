#pragma once
/// \file frame_source.hpp
/// Where the frames of the host command come from: a folder of pictures, a Y4M file, a Y4M stream on standard
/// input, or a camera.
#include <cstdint>
#include <memory>
#include <string>

#include "pliant/frame.hpp"
#include "pliant/status.hpp"

namespace pliant::host {

/// Frames a second.
struct FrameRate {
  int numerator = 25, denominator = 1;
  double per_second() const { return static_cast<double>(numerator) / denominator; }
};

/// Luma frames of one size, one after the other.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  FrameSource(const FrameSource&) = delete;
  FrameSource& operator=(const FrameSource&) = delete;

  /// Reads the next frame. The view holds until the next call. Its sequence counts from 0, its time is
  /// sequence / rate; a camera gives its own time and number, and the view is of its own memory.
  /// `end_of_stream` after the last one; `truncated` where the data stop in mid-frame, all frames before it
  /// having been given; `size_mismatch` for a picture of another size; `io_error` for a failed read or
  /// malformed data; `camera_lost` for a camera that was unplugged. From then on every call returns the same, and message() says what is wrong, and where.
  Status next(FrameView& frame);

  int width() const { return width_; }
  int height() const { return height_; }
  /// As the stream says; 25 where it does not, as for a folder.
  FrameRate rate() const { return rate_; }
  /// A camera: times and numbers are its own, there is no end, and who is late misses frames.
  bool is_live() const { return is_live_; }
  /// One line without a final stop, naming the file; empty as long as nothing is wrong.
  const std::string& message() const { return message_; }

 protected:
  FrameSource() = default;
  /// Sets `frame.data` to the luma of frame number `index`. Everything else is set already, for width * height bytes in rows
  /// without padding, and may be changed.
  virtual Status read(std::uint32_t index, FrameView& frame) = 0;
  Status fail(Status status, std::string message) {
    message_ = std::move(message);
    return status;
  }

  int width_ = 0, height_ = 0;
  FrameRate rate_;
  bool is_live_ = false;

 private:
  std::uint32_t index_ = 0;
  Status status_ = Status::ok;
  std::string message_;
};

/// A source, or why there is none.
struct OpenedFrames {
  std::unique_ptr<FrameSource> source;  ///< null on failure
  std::string message;                  ///< then: one line that names the file and what is wrong with it
};

/// "-": a Y4M stream on standard input; "camera:[ID or INDEX][@WxH]": a camera; a folder; a PGM or PPM picture (one
/// frame); anything else is read as Y4M.
OpenedFrames open_frames(const std::string& name);

/// All *.pgm, *.ppm and *.pnm of a folder, in the order of their names with numbers in them as numbers (2
/// before 10).
OpenedFrames open_folder(const std::string& path);
/// A Y4M file, or "-" for standard input.
OpenedFrames open_y4m(const std::string& path);

}  // namespace pliant::host
