#pragma once
/// \file libcamera.hpp
/// Frames from any camera that libcamera knows, as `FrameView`s in the camera's own memory. Linux; the library
/// pliant::libcamera, which is there where libcamera was found. For host code: it uses the heap and a thread of libcamera's.
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "pliant/frame.hpp"

namespace pliant {

struct CameraInfo {
  std::string id;     ///< stable name of where it is plugged in
  std::string model;  ///< what it calls itself; may be empty
};

/// All cameras, in libcamera's order. `io_error` when libcamera does not start.
Status list_cameras(std::vector<CameraInfo>* cameras);

struct CameraOptions {
  std::string camera;              ///< id; or a number, counted as `list_cameras` does; empty: the first one
  int width = 640, height = 480;   ///< wanted; the nearest that the camera has is taken
  std::size_t queue_capacity = 2;  ///< frames that wait for `next`; a further one pushes out the oldest
  std::chrono::milliseconds patience{3000};  ///< without a frame until the camera is taken for lost
};

/// One camera. Open it, start it, take frames, stop it; it may be started again. One thread at a time.
class CameraStream {
 public:
  CameraStream();
  ~CameraStream();  ///< stops and closes
  CameraStream(const CameraStream&) = delete;
  CameraStream& operator=(const CameraStream&) = delete;

  /// Takes hold of a camera and agrees on a format, planar luma where it has that, else packed YUYV and its like.
  /// \return not_found (no such camera, or none of its formats has luma that can be read), io_error (it is in use, or
  ///         refuses); message() then says which.
  Status open(const CameraOptions& options);
  /// Lets frames come. \return not_started when no camera is open; io_error; camera_lost.
  Status start();
  /// The next frame, waited for. The view is of the camera's buffer, without a copy, and holds until the next call; its
  /// time is the camera's (ns, of the monotonic clock), its sequence the camera's number, so that gaps tell of frames that
  /// were lost on the way or dropped because they were not taken in time. Damaged frames are left out, and counted.
  /// \return not_started; end_of_stream after `stop`; camera_lost when it was unplugged or gave nothing for `patience`.
  Status next(FrameView* frame);
  /// No more frames; the last view is void. A lost camera is only let go of: libcamera 0.0.3 aborts when it is stopped.
  void stop();

  int width() const;
  int height() const;
  /// What was agreed on, as four characters.
  std::string format() const;
  /// Since `start`: frames pushed out of the queue, and frames that the camera marked as damaged.
  std::uint64_t dropped_count() const;
  std::uint64_t damaged_count() const;
  /// One line without a final stop; empty as long as nothing is wrong.
  const std::string& message() const { return message_; }

 private:
  struct Session;
  Status fail(Status status, std::string message);

  std::unique_ptr<Session> session_;
  CameraOptions options_;
  std::string message_;
};

}  // namespace pliant
