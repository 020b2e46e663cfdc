#pragma once
/// \file libcamera.hpp
/// Frames from any camera that libcamera supports, as `FrameView`s of the camera's own memory.
/// Linux only, in the library pliant::libcamera, which is built if libcamera is found. It uses the heap and a thread
/// of libcamera.
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "pliant/frame.hpp"

namespace pliant {

struct CameraSession;

/// One camera of the system.
struct CameraInfo {
  std::string id;     ///< stable name, by the place where it is plugged in
  std::string model;  ///< the name that it reports; may be empty
};

/// Lists all cameras in libcamera's order. \return `io_error` if libcamera does not start.
Status list_cameras(std::vector<CameraInfo>* cameras);

/// Which camera to open, and how.
struct CameraOptions {
  std::string camera;             ///< id, or a number in the order of `list_cameras`; empty: the first one
  int width = 640, height = 480;  ///< wanted size, px; the nearest that the camera offers is used
};

/// One camera: open, start, next ..., stop. It can be started again. Not thread-safe.
class CameraStream {
 public:
  CameraStream();
  ~CameraStream();  ///< stops and closes
  CameraStream(const CameraStream&) = delete;
  CameraStream& operator=(const CameraStream&) = delete;

  /// Acquires a camera and chooses the offered size nearest to the wanted one; of equal sizes, planar luma
  /// before a packed format such as YUYV.
  /// \return `not_found` (no such camera, no format with luma that can be read, or it refuses the configuration),
  ///         `io_error` (libcamera does not start, the camera is in use, or it gives no buffers or requests). message()
  ///         then says which, and the stream is closed.
  Status open(const CameraOptions& options);
  /// Starts the flow of frames. \return `not_started` if no camera is open, `io_error`, `camera_lost`.
  Status start();
  /// Waits for the next frame. The view is of the camera's buffer, without a copy, and is valid until the next call.
  /// Its time is the camera's (ns, monotonic clock), its sequence the camera's number: a gap means frames that were
  /// lost, or dropped because two others were waiting already. Damaged frames are skipped and counted.
  /// \return `not_started`; `camera_lost` if the camera was unplugged or gave no frame for three seconds.
  Status next(FrameView* frame);
  /// Stops the flow of frames; the last view becomes invalid. A lost camera is abandoned, because libcamera 0.0.3
  /// aborts if it is stopped.
  void stop();

  int width() const;   ///< Of the frames, px.
  int height() const;  ///< Of the frames, px.
  /// The format, as four characters.
  std::string format() const;
  std::uint64_t dropped_count() const;  ///< Frames since `start` that were dropped from the queue.
  std::uint64_t damaged_count() const;  ///< Frames since `start` that the camera marked as damaged.
  /// What went wrong: one line without a final stop; empty if nothing did.
  const std::string& message() const { return message_; }

 private:
  Status fail(Status status, std::string message);

  std::unique_ptr<CameraSession> session_;
  std::string message_;
};

}  // namespace pliant
