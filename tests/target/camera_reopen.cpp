// Opens a camera again while the camera manager stays, as where a second camera is open or one was lost. Run by camera_vm.sh.
// Prints a line and exits 0 if each opening gives new frames only.
#include <cstdio>
#include <memory>

#include "pliant/libcamera.hpp"

namespace libcamera {
class CameraManager;
}

namespace pliant {
std::shared_ptr<libcamera::CameraManager> shared_camera_manager();
}

int main() {
  constexpr int kOpenings = 3, kFrames = 8;
  const auto kept = pliant::shared_camera_manager();
  pliant::CameraStream camera;
  for (int k = 0; k < kOpenings; ++k) {
    if (camera.open({}) != pliant::Status::ok || camera.start() != pliant::Status::ok) {
      std::printf("opening %d: %s\n", k, camera.message().c_str());
      return 1;
    }
    pliant::FrameView frame;
    std::int64_t last_ns = 0;
    for (int n = 0; n < kFrames; ++n) {
      if (camera.next(&frame) != pliant::Status::ok || frame.time_ns <= last_ns) {
        std::printf("opening %d, frame %d: not a new frame %s\n", k, n, camera.message().c_str());
        return 1;
      }
      last_ns = frame.time_ns;
    }
  }
  std::printf("%d openings\n", kOpenings);
  return 0;
}
