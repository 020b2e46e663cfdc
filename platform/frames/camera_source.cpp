// A camera as a source of frames for the command; only the message where the build has no libcamera.
#include "frames/camera_spec.hpp"
#include "frames/sources.hpp"

#if PLIANT_HAS_LIBCAMERA
#include "pliant/libcamera.hpp"
#endif

namespace pliant {

namespace {

/// The whole of `text` as a side of a picture; 0 for anything else.
int side_of(const std::string& text) {
  if (text.empty() || text.size() > 4 || text.find_first_not_of("0123456789") != std::string::npos) return 0;
  const int side = std::stoi(text);
  return side >= 16 && side <= 8192 ? side : 0;
}

#if PLIANT_HAS_LIBCAMERA

class CameraSource : public FrameSource {
 public:
  /// Empty on success, else what is wrong.
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

#endif

}  // namespace

bool parse_camera_spec(const std::string& name, CameraSpec* spec) {
  const std::string scheme = "camera:";
  if (name.rfind(scheme, 0) != 0) return false;
  *spec = {};
  spec->camera = name.substr(scheme.size());
  const std::size_t at = spec->camera.rfind('@');
  if (at == std::string::npos) return true;
  const std::string size = spec->camera.substr(at + 1);
  const std::size_t x = size.find('x');
  const int width = side_of(size.substr(0, x));
  const int height = x == std::string::npos ? 0 : side_of(size.substr(x + 1));
  if (width == 0 || height == 0) return true;
  spec->camera.resize(at);
  spec->width = width;
  spec->height = height;
  return true;
}

OpenedFrames open_camera(const CameraSpec& spec) {
#if PLIANT_HAS_LIBCAMERA
  auto source = std::make_unique<CameraSource>();
  const std::string wrong = source->open(spec);
  if (!wrong.empty()) return {nullptr, "camera: " + wrong};
  return {std::move(source), {}};
#else
  static_cast<void>(spec);
  return {nullptr, "camera: this program was built without libcamera"};
#endif
}

}  // namespace pliant
