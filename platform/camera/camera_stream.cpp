#include <libcamera/libcamera.h>

#include "camera/camera_session.hpp"
#include "pliant/libcamera.hpp"

namespace pliant {

namespace {

/// Time without a frame after which a camera counts as lost. Long enough for a slow sensor's first exposure; round
/// value, not tuned.
constexpr std::chrono::milliseconds kPatience{3000};

}  // namespace

CameraStream::CameraStream() = default;
CameraStream::~CameraStream() {
  stop();
}

Status CameraStream::fail(Status status, std::string message) {
  message_ = std::move(message);
  return status;
}

Status CameraStream::open(const CameraOptions& options) {
  stop();
  session_.reset();
  message_.clear();
  auto session = std::make_unique<CameraSession>();
  session->manager = shared_camera_manager();
  if (session->manager == nullptr) return fail(Status::io_error, "libcamera does not start");
  if (session->manager->cameras().empty()) return fail(Status::not_found, "no camera");
  const auto camera = find_camera(*session->manager, options.camera);
  if (camera == nullptr) return fail(Status::not_found, "no camera '" + options.camera + "'");
  if (camera->acquire() != 0) return fail(Status::io_error, "camera '" + camera->id() + "' is in use");
  session->camera = camera;
  std::string wrong = session->configure(options.width, options.height);
  if (!wrong.empty()) return fail(Status::not_found, "camera '" + camera->id() + "' " + wrong);
  wrong = session->make_requests();
  if (!wrong.empty()) return fail(Status::io_error, "camera '" + camera->id() + "' " + wrong);
  CameraSession* const s = session.get();
  camera->requestCompleted.connect(s, [s](libcamera::Request* r) { s->on_completed(r); });
  camera->disconnected.connect(s, [s] { s->on_disconnected(); });
  session_ = std::move(session);
  return Status::ok;
}

Status CameraStream::start() {
  if (session_ == nullptr) return Status::not_started;
  if (session_->is_running) return Status::ok;
  if (session_->is_lost) return fail(Status::camera_lost, "the camera was unplugged");
  if (session_->start()) return Status::ok;
  return fail(Status::io_error, "camera '" + session_->camera->id() + "' does not start");
}

Status CameraStream::next(FrameView* frame) {
  if (frame == nullptr) return Status::bad_argument;
  if (session_ == nullptr || !session_->is_running) return Status::not_started;
  CameraSession& s = *session_;
  s.release_held();
  const auto until = std::chrono::steady_clock::now() + kPatience;
  for (;;) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(until - std::chrono::steady_clock::now());
    const auto request = left.count() > 0 ? s.queue->pop(left) : std::nullopt;
    if (!request) {
      const bool was_unplugged = s.is_lost.exchange(true);
      stop();
      if (was_unplugged) return fail(Status::camera_lost, "the camera was unplugged");
      return fail(Status::camera_lost, "the camera gives no more frames");
    }
    if (s.show(*request, frame) == Status::ok) return Status::ok;
    ++s.damaged;
    s.submit(*request);
  }
}

void CameraStream::stop() {
  if (session_ == nullptr) return;
  if (session_->is_lost) {
    session_->queue->close();
    static_cast<void>(session_.release());  // leaked, as CameraSession says
    return;
  }
  session_->stop();
}

int CameraStream::width() const {
  return session_ == nullptr ? 0 : static_cast<int>(session_->configuration->at(0).size.width);
}
int CameraStream::height() const {
  return session_ == nullptr ? 0 : static_cast<int>(session_->configuration->at(0).size.height);
}
std::string CameraStream::format() const {
  return session_ == nullptr ? std::string() : fourcc_text(session_->layout->format);
}
std::uint64_t CameraStream::dropped_count() const {
  return session_ == nullptr ? 0 : session_->queue->dropped_count();
}
std::uint64_t CameraStream::damaged_count() const {
  return session_ == nullptr ? 0 : session_->damaged.load();
}

Status list_cameras(std::vector<CameraInfo>* cameras) {
  if (cameras == nullptr) return Status::bad_argument;
  const auto manager = shared_camera_manager();
  if (manager == nullptr) return Status::io_error;
  cameras->clear();
  for (const auto& camera : manager->cameras())
    cameras->push_back(
        {camera->id(), std::string(camera->properties().get(libcamera::properties::Model).value_or(""))});
  return Status::ok;
}

}  // namespace pliant
