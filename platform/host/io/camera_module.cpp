// A camera as a source of frames for the command.
#include "host/io/camera_module.hpp"

#include "host/io/camera_spec.hpp"
#include "pliant/libcamera.hpp"

namespace pliant::host {

namespace {

class CameraSource : public FrameSource {
 public:
  /// \return the error; empty on success.
  std::string open(const CameraSpec& spec) {
    CameraOptions options;
    options.camera = spec.camera;
    options.width = spec.width;
    options.height = spec.height;
    if (stream_.open(options) != Status::ok || stream_.start() != Status::ok) return stream_.message();
    width_ = stream_.width();
    height_ = stream_.height();
    rate_ = {30, 1};
    is_live_ = true;
    return {};
  }

 private:
  Status read(std::uint32_t, FrameView& frame) override {
    const Status status = stream_.next(&frame);
    return status == Status::ok ? status : fail(status, "camera: " + stream_.message());
  }
  CameraStream stream_;
};

OpenedFrames open_source(const CameraSpec& spec) {
  auto source = std::make_unique<CameraSource>();
  const std::string wrong = source->open(spec);
  if (!wrong.empty()) return {nullptr, "camera: " + wrong};
  return {std::move(source), {}};
}

}  // namespace

}  // namespace pliant::host

extern "C" const pliant::host::CameraModule pliant_camera_module;
const pliant::host::CameraModule pliant_camera_module = {pliant::host::open_source, pliant::list_cameras};
