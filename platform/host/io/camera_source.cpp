// Opens cameras by name through the camera library. Without libcamera in the build it only returns an error.
#include "host/io/camera_module.hpp"
#include "host/io/camera_spec.hpp"

#if PLIANT_HAS_LIBCAMERA
#include <dlfcn.h>
#endif

namespace pliant::host {

namespace {

/// Parses a side of a picture; 0 for anything but a number from 16 to 8192.
int side_of(const std::string& text) {
  if (text.empty() || text.size() > 4 || text.find_first_not_of("0123456789") != std::string::npos) return 0;
  const int side = std::stoi(text);
  return side >= 16 && side <= 8192 ? side : 0;
}

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

#if PLIANT_HAS_LIBCAMERA

const CameraModule* load_camera_module(std::string* wrong) {
  // In the program's folder, in the folder above (for tests), and where it is installed.
  constexpr const char* kPlaces[] = {"$ORIGIN/pliant-camera.so", "$ORIGIN/../pliant-camera.so",
                                     "$ORIGIN/" PLIANT_CAMERA_MODULE_DIR "/pliant-camera.so"};
  void* library = nullptr;
  for (const char* place : kPlaces) {
    if (library == nullptr) library = ::dlopen(place, RTLD_NOW | RTLD_LOCAL);
  }
  void* const module = library != nullptr ? ::dlsym(library, "pliant_camera_module") : nullptr;
  if (module == nullptr) *wrong = std::string("no camera support: ") + ::dlerror();
  return static_cast<const CameraModule*>(module);
}

#else

const CameraModule* load_camera_module(std::string* wrong) {
  *wrong = "this program was built without libcamera";
  return nullptr;
}

#endif

OpenedFrames open_camera(const CameraSpec& spec) {
  std::string wrong;
  const CameraModule* const module = load_camera_module(&wrong);
  if (module == nullptr) return {nullptr, "camera: " + wrong};
  return module->open(spec);
}

}  // namespace pliant::host
