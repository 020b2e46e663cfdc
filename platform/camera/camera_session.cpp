#include "camera/camera_session.hpp"

#include <cerrno>
#include <cstring>
#include <mutex>

namespace pliant {

namespace lc = libcamera;

namespace {

/// Frames that wait to be read. A further one drops the oldest: more would add delay, fewer would lose frames to
/// jitter. Round value, not tuned.
constexpr std::size_t kQueueCapacity = 2;

std::vector<FormatOffer> offers_of(const lc::StreamFormats& formats) {
  std::vector<FormatOffer> offers;
  for (const lc::PixelFormat& format : formats.pixelformats()) {
    if (format.modifier() != 0) continue;  // tiled or compressed
    FormatOffer offer;
    offer.format = format.fourcc();
    for (const lc::Size& s : formats.sizes(format))
      offer.sizes.push_back({static_cast<int>(s.width), static_cast<int>(s.height)});
    offers.push_back(std::move(offer));
  }
  return offers;
}

}  // namespace

// The lock is also held while the last user's manager stops: libcamera aborts the process if another one begins beside it. No
// object here is destroyed at the end of the program, when a stream of the caller's may still be there.
std::shared_ptr<lc::CameraManager> shared_camera_manager() {
  static std::mutex mutex;
  static lc::CameraManager* current = nullptr;
  static std::size_t users = 0;
  {
    const std::lock_guard<std::mutex> lock(mutex);
    if (users == 0) {
      auto fresh = std::make_unique<lc::CameraManager>();
      if (fresh->start() != 0) return nullptr;
      current = fresh.release();
    }
    ++users;
  }
  return {current, [](lc::CameraManager* manager) {
            const std::lock_guard<std::mutex> lock(mutex);
            if (--users > 0) return;
            manager->stop();
            delete manager;
          }};
}

std::shared_ptr<lc::Camera> find_camera(const lc::CameraManager& manager, const std::string& name) {
  const auto cameras = manager.cameras();
  if (name.find_first_not_of("0123456789") == std::string::npos) {
    const std::size_t index = name.size() > 9 ? cameras.size() : name.empty() ? 0 : std::stoul(name);
    return index < cameras.size() ? cameras[index] : nullptr;
  }
  for (const auto& camera : cameras)
    if (camera->id() == name) return camera;
  return nullptr;
}

CameraSession::~CameraSession() {
  if (camera == nullptr) return;
  // Where something else keeps the manager, the camera stays, and is opened again: its calls must not come here then.
  camera->requestCompleted.disconnect(this);
  camera->disconnected.disconnect(this);
  requests.clear();
  planes.clear();
  if (allocator != nullptr) allocator->free(stream);
  allocator.reset();
  camera->release();
  camera.reset();
}

std::string CameraSession::configure(int width, int height) {
  configuration = camera->generateConfiguration({lc::StreamRole::Viewfinder});
  if (configuration == nullptr || configuration->empty()) return "has no viewfinder stream";
  lc::StreamConfiguration& wanted = configuration->at(0);
  const auto offers = offers_of(wanted.formats());
  std::uint32_t format = 0;
  FormatOffer::Size size;
  if (!choose_format(offers, width, height, &format, &size)) {
    std::string names;
    for (const FormatOffer& offer : offers) names += (names.empty() ? "" : ", ") + fourcc_text(offer.format);
    return "has no format whose luma can be read, only " + (names.empty() ? "tiled ones" : names);
  }
  wanted.pixelFormat = lc::PixelFormat(format);
  wanted.size = lc::Size(static_cast<unsigned>(size.width), static_cast<unsigned>(size.height));
  // Two in the camera, one held by the caller, the others in the queue.
  wanted.bufferCount = static_cast<unsigned>(kQueueCapacity) + 3;
  if (configuration->validate() == lc::CameraConfiguration::Invalid) return "refuses its own format";
  layout = luma_layout(wanted.pixelFormat.fourcc());
  if (layout == nullptr || wanted.pixelFormat.modifier() != 0)
    return "insists on the format " + fourcc_text(wanted.pixelFormat.fourcc());
  if (camera->configure(configuration.get()) != 0) return "cannot be configured";
  stream = wanted.stream();
  return {};
}

std::string CameraSession::make_requests() {
  PLIANT_ASSERT(stream != nullptr);
  allocator = std::make_unique<lc::FrameBufferAllocator>(camera);
  if (allocator->allocate(stream) <= 0) return "gives no buffers";
  for (const auto& buffer : allocator->buffers(stream)) {
    if (buffer->planes().empty()) return "gives empty buffers";
    planes.push_back(std::make_unique<MappedPlane>(buffer->planes()[0]));
    if (!planes.back()->is_valid())
      return "gives buffers that cannot be read: " + std::string(std::strerror(errno));
    auto request = camera->createRequest(planes.size() - 1);
    if (request == nullptr || request->addBuffer(stream, buffer.get()) != 0) return "takes no requests";
    requests.push_back(std::move(request));
  }
  // If all buffers could be in the queue, none would be left for the camera, and it would miss the newest frames.
  const std::size_t spare = requests.size() > 2 ? requests.size() - 2 : 1;
  queue = std::make_unique<FrameQueue<lc::Request*>>(kQueueCapacity < spare ? kQueueCapacity : spare);
  return {};
}

bool CameraSession::start() {
  queue->reset();
  damaged = 0;
  held = nullptr;
  active_requests = requests.size();
  if (camera->start() != 0) return false;
  is_running = true;
  for (const auto& request : requests) submit(request.get());
  return true;
}

void CameraSession::stop() {
  if (!is_running) return;
  queue->close();  // so that no request is handed in while the camera stops
  camera->stop();
  is_running = false;
}

void CameraSession::on_completed(lc::Request* request) {
  if (request->status() == lc::Request::RequestCancelled) return retire();
  const lc::FrameBuffer* buffer = request->findBuffer(stream);
  if (buffer == nullptr || buffer->metadata().status != lc::FrameMetadata::FrameSuccess) {
    ++damaged;
    return submit(request);
  }
  if (const auto dropped = queue->push(request)) submit(*dropped);
}

void CameraSession::on_disconnected() {
  is_lost = true;
  queue->close();
}

void CameraSession::submit(lc::Request* request) {
  if (is_lost || queue->is_closed()) return;
  request->reuse(lc::Request::ReuseBuffers);
  if (camera->queueRequest(request) != 0) retire();
}

// A cancelled request is not used again: the camera may be disconnecting, and handing it work then is fatal.
void CameraSession::retire() {
  if (--active_requests == 0) queue->close();
}

void CameraSession::release_held() {
  if (held == nullptr) return;
  planes[held->cookie()]->end_reading();
  submit(held);
  held = nullptr;
}

Status CameraSession::show(lc::Request* request, FrameView* frame) {
  const lc::FrameMetadata& metadata = request->findBuffer(stream)->metadata();
  std::size_t filled = 0;
  for (const auto& plane : metadata.planes()) {
    filled = plane.bytesused;
    break;
  }
  const lc::StreamConfiguration& agreed = configuration->at(0);
  FrameView view;
  view.time_ns = static_cast<std::int64_t>(metadata.timestamp);
  view.sequence = metadata.sequence;
  const MappedPlane& plane = *planes[request->cookie()];
  const Status status = view_luma(*layout, plane.memory(filled), static_cast<int>(agreed.size.width),
                                  static_cast<int>(agreed.size.height), agreed.stride, &view);
  if (status != Status::ok) return status;
  plane.begin_reading();
  held = request;
  *frame = view;
  return Status::ok;
}

}  // namespace pliant
