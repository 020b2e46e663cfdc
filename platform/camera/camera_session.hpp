#pragma once
// One acquired camera of libcamera with its buffers. A request carries one buffer for one frame: it goes to the
// camera, comes back filled on libcamera's thread, waits in the queue, is read, and goes to the camera again. Written
// for libcamera 0.0.3 to 0.7. What changed in between (the transform of a configuration, the constness of a request's
// metadata, the types of the lists of roles and texts) is not used, or spelt so that both read it.
#include <libcamera/libcamera.h>

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "camera/frame_queue.hpp"
#include "camera/mapped_plane.hpp"

namespace pliant {

/// The process's camera manager: libcamera allows one. It lives as long as anyone uses it. Null if it does not start.
std::shared_ptr<libcamera::CameraManager> shared_camera_manager();
/// The camera with this id or number, the first one for an empty name; null if there is none.
std::shared_ptr<libcamera::Camera> find_camera(const libcamera::CameraManager& manager,
                                               const std::string& name);

/// An acquired camera. Its members are set up in the order acquire (by the owner), `configure`, `make_requests`,
/// `start`. If the camera is lost the session must be leaked: libcamera's thread may still be inside it, and neither
/// stopping nor releasing a lost camera is safe in all versions.
struct CameraSession {
  ~CameraSession();

  /// Negotiates a format. \return empty, or an error message.
  std::string configure(int width, int height);
  /// Creates the buffers, their requests and the queue. \return empty, or an error message.
  std::string make_requests();
  /// Starts the camera with all requests. \return false if it refuses.
  bool start();
  void stop();

  /// Called on libcamera's thread.
  void on_completed(libcamera::Request* request);
  void on_disconnected();

  /// Hands a request to the camera.
  void submit(libcamera::Request* request);
  /// Hands the request of the last shown frame back to the camera, if there is one.
  void release_held();
  /// Points `frame` at the luma of a completed request, which is held then. \return as `view_luma`.
  Status show(libcamera::Request* request, FrameView* frame);

  std::shared_ptr<libcamera::CameraManager> manager;
  std::shared_ptr<libcamera::Camera> camera;
  std::unique_ptr<libcamera::CameraConfiguration> configuration;
  libcamera::Stream* stream = nullptr;
  const LumaLayout* layout = nullptr;
  std::unique_ptr<libcamera::FrameBufferAllocator> allocator;
  std::vector<std::unique_ptr<MappedPlane>> planes;  // by the request's cookie
  std::vector<std::unique_ptr<libcamera::Request>> requests;
  std::unique_ptr<FrameQueue<libcamera::Request*>> queue;
  libcamera::Request* held = nullptr;  // the last view is of its buffer
  bool is_running = false;
  std::atomic<bool> is_lost{false};
  std::atomic<std::size_t> active_requests{0};  // those that were not cancelled
  std::atomic<std::uint64_t> damaged{0};        // frames

 private:
  void retire();
};

}  // namespace pliant
