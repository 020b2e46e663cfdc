// One camera through libcamera. A request carries one buffer for one picture: it goes to the camera, comes back filled on
// libcamera's thread, waits in the queue, is looked at, and goes to the camera again.
// Written for libcamera 0.0.3 to 0.7: whatever changed in between (the transform of a configuration, the constness of a
// request's metadata, the type of the list of roles and of texts) is either not used or spelt so that both read it.
#include <fcntl.h>
#include <libcamera/libcamera.h>
#include <linux/dma-buf.h>
#include <sys/ioctl.h>
#include <sys/mman.h>

#include <atomic>
#include <cstring>
#include <mutex>

#include "camera/frame_queue.hpp"
#include "camera/luma_layout.hpp"
#include "pliant/libcamera.hpp"

namespace pliant {

namespace {

namespace lc = libcamera;

/// libcamera allows one manager a process; it lives as long as anyone uses it. Null when it does not start.
std::shared_ptr<lc::CameraManager> shared_manager() {
  static std::mutex mutex;
  static std::weak_ptr<lc::CameraManager> current;
  const std::lock_guard<std::mutex> lock(mutex);
  if (auto manager = current.lock()) return manager;
  auto fresh = std::make_unique<lc::CameraManager>();
  if (fresh->start() != 0) return nullptr;
  std::shared_ptr<lc::CameraManager> manager(fresh.release(), [](lc::CameraManager* m) {
    m->stop();
    delete m;
  });
  current = manager;
  return manager;
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

/// The first plane of a buffer, for reading.
class MappedPlane {
 public:
  explicit MappedPlane(const lc::FrameBuffer::Plane& plane)
      : fd_(plane.fd), offset_(plane.offset == lc::FrameBuffer::Plane::kInvalidOffset ? 0 : plane.offset) {
    // An offset need not be a multiple of the page size, so everything in front of it is mapped too.
    mapped_bytes_ = std::size_t{offset_} + plane.length;
    void* const start = mmap(nullptr, mapped_bytes_, PROT_READ, MAP_SHARED, fd_.get(), 0);
    start_ = start == MAP_FAILED ? nullptr : static_cast<const std::uint8_t*>(start);
  }
  ~MappedPlane() {
    if (start_ != nullptr) munmap(const_cast<std::uint8_t*>(start_), mapped_bytes_);
  }
  MappedPlane(const MappedPlane&) = delete;
  MappedPlane& operator=(const MappedPlane&) = delete;

  bool is_valid() const { return start_ != nullptr; }
  PlaneMemory memory(std::size_t filled) const {
    const std::size_t length = mapped_bytes_ - offset_;
    return {start_ + offset_, filled > 0 && filled < length ? filled : length};
  }
  /// Brackets reading, for devices whose memory does not keep in step with the caches. A buffer that needs none refuses;
  /// that is fine.
  void begin_reading() const { sync(DMA_BUF_SYNC_START); }
  void end_reading() const { sync(DMA_BUF_SYNC_END); }

 private:
  void sync(std::uint64_t which) const {
    dma_buf_sync argument{};
    argument.flags = which | DMA_BUF_SYNC_READ;
    ioctl(fd_.get(), DMA_BUF_IOCTL_SYNC, &argument);
  }

  lc::SharedFD fd_;
  std::size_t offset_;
  std::size_t mapped_bytes_ = 0;
  const std::uint8_t* start_ = nullptr;
};

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

/// Everything that goes with one acquired camera. When the camera is lost the session is leaked: libcamera's thread may
/// still be in it, and neither stopping nor releasing what is gone is safe in all versions.
struct CameraStream::Session {
  ~Session() {
    if (camera == nullptr) return;
    requests.clear();
    planes.clear();
    if (allocator != nullptr) allocator->free(stream);
    allocator.reset();
    camera->release();
    camera.reset();
  }

  std::string configure(const CameraOptions& options);
  std::string make_requests(std::size_t queue_capacity);
  void on_completed(lc::Request* request);
  void on_disconnected() {
    is_lost = true;
    queue->close();
  }
  void submit(lc::Request* request);
  void retire();
  Status show(lc::Request* request, FrameView* frame);

  std::shared_ptr<lc::CameraManager> manager;
  std::shared_ptr<lc::Camera> camera;
  std::unique_ptr<lc::CameraConfiguration> configuration;
  lc::Stream* stream = nullptr;
  const LumaLayout* layout = nullptr;
  std::unique_ptr<lc::FrameBufferAllocator> allocator;
  std::vector<std::unique_ptr<MappedPlane>> planes;  // by the request's cookie
  std::vector<std::unique_ptr<lc::Request>> requests;
  std::unique_ptr<FrameQueue<lc::Request*>> queue;
  lc::Request* held = nullptr;  // its buffer is what the last view shows
  bool is_running = false;
  std::atomic<bool> is_lost{false};
  std::atomic<std::size_t> working{0};  // requests that were not cancelled
  std::atomic<std::uint64_t> damaged{0};
};

/// Agrees on a format. Empty, or what is wrong.
std::string CameraStream::Session::configure(const CameraOptions& options) {
  configuration = camera->generateConfiguration({lc::StreamRole::Viewfinder});
  if (configuration == nullptr || configuration->empty()) return "has no viewfinder stream";
  lc::StreamConfiguration& wanted = configuration->at(0);
  const auto offers = offers_of(wanted.formats());
  std::uint32_t format = 0;
  FormatOffer::Size size;
  if (!choose_format(offers, options.width, options.height, &format, &size)) {
    std::string names;
    for (const FormatOffer& offer : offers) names += (names.empty() ? "" : ", ") + fourcc_text(offer.format);
    return "has no format whose luma can be read, only " + (names.empty() ? "tiled ones" : names);
  }
  wanted.pixelFormat = lc::PixelFormat(format);
  wanted.size = lc::Size(static_cast<unsigned>(size.width), static_cast<unsigned>(size.height));
  // Two in the camera, one in our hands, the others in the queue.
  wanted.bufferCount = static_cast<unsigned>(options.queue_capacity) + 3;
  if (configuration->validate() == lc::CameraConfiguration::Invalid) return "refuses its own format";
  layout = luma_layout(wanted.pixelFormat.fourcc());
  if (layout == nullptr || wanted.pixelFormat.modifier() != 0)
    return "insists on the format " + fourcc_text(wanted.pixelFormat.fourcc());
  if (camera->configure(configuration.get()) != 0) return "cannot be configured";
  stream = wanted.stream();
  return {};
}

std::string CameraStream::Session::make_requests(std::size_t queue_capacity) {
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
  // With all buffers in the queue none would be left for the camera, and the newest pictures would be the ones that miss.
  const std::size_t spare = requests.size() > 2 ? requests.size() - 2 : 1;
  queue = std::make_unique<FrameQueue<lc::Request*>>(queue_capacity < spare ? queue_capacity : spare);
  return {};
}

/// On libcamera's thread.
void CameraStream::Session::on_completed(lc::Request* request) {
  if (request->status() == lc::Request::RequestCancelled) return retire();
  const lc::FrameBuffer* buffer = request->findBuffer(stream);
  if (buffer == nullptr || buffer->metadata().status != lc::FrameMetadata::FrameSuccess) {
    ++damaged;
    return submit(request);
  }
  if (const auto dropped = queue->push(request)) submit(*dropped);
}

void CameraStream::Session::submit(lc::Request* request) {
  if (is_lost || queue->is_closed()) return;
  request->reuse(lc::Request::ReuseBuffers);
  if (camera->queueRequest(request) != 0) retire();
}

/// One request fewer. A cancelled one is not used again: the camera may be going, and handing it work then is fatal.
void CameraStream::Session::retire() {
  if (--working == 0) queue->close();
}

Status CameraStream::Session::show(lc::Request* request, FrameView* frame) {
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
  *frame = view;
  return Status::ok;
}

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
  options_ = options;
  auto session = std::make_unique<Session>();
  session->manager = shared_manager();
  if (session->manager == nullptr) return fail(Status::io_error, "libcamera does not start");
  if (session->manager->cameras().empty()) return fail(Status::not_found, "no camera");
  const auto camera = find_camera(*session->manager, options.camera);
  if (camera == nullptr) return fail(Status::not_found, "no camera '" + options.camera + "'");
  if (camera->acquire() != 0) return fail(Status::io_error, "camera '" + camera->id() + "' is in use");
  session->camera = camera;
  std::string wrong = session->configure(options);
  if (!wrong.empty()) return fail(Status::not_found, "camera '" + camera->id() + "' " + wrong);
  wrong = session->make_requests(options.queue_capacity);
  if (!wrong.empty()) return fail(Status::io_error, "camera '" + camera->id() + "' " + wrong);
  Session* const s = session.get();
  camera->requestCompleted.connect(s, [s](lc::Request* r) { s->on_completed(r); });
  camera->disconnected.connect(s, [s] { s->on_disconnected(); });
  session_ = std::move(session);
  return Status::ok;
}

Status CameraStream::start() {
  if (session_ == nullptr) return Status::not_started;
  Session& s = *session_;
  if (s.is_running) return Status::ok;
  if (s.is_lost) return fail(Status::camera_lost, "the camera was unplugged");
  s.queue->reset();
  s.damaged = 0;
  s.held = nullptr;
  s.working = s.requests.size();
  if (s.camera->start() != 0) return fail(Status::io_error, "camera '" + s.camera->id() + "' does not start");
  s.is_running = true;
  for (const auto& request : s.requests) s.submit(request.get());
  return Status::ok;
}

Status CameraStream::next(FrameView* frame) {
  if (frame == nullptr) return Status::bad_argument;
  if (session_ == nullptr || !session_->is_running) return Status::not_started;
  Session& s = *session_;
  const auto release_held = [&s] {
    if (s.held == nullptr) return;
    s.planes[s.held->cookie()]->end_reading();
    s.submit(s.held);
    s.held = nullptr;
  };
  release_held();
  const auto until = std::chrono::steady_clock::now() + options_.patience;
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
    if (s.show(*request, frame) == Status::ok) {
      s.held = *request;
      return Status::ok;
    }
    ++s.damaged;
    s.submit(*request);
  }
}

void CameraStream::stop() {
  if (session_ == nullptr) return;
  Session& s = *session_;
  if (s.is_lost) {
    s.queue->close();
    static_cast<void>(session_.release());
    return;
  }
  if (!s.is_running) return;
  s.queue->close();  // so that nothing is handed in while the camera stops
  s.camera->stop();
  s.is_running = false;
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
  const auto manager = shared_manager();
  if (manager == nullptr) return Status::io_error;
  cameras->clear();
  for (const auto& camera : manager->cameras())
    cameras->push_back(
        {camera->id(), std::string(camera->properties().get(lc::properties::Model).value_or(""))});
  return Status::ok;
}

}  // namespace pliant
