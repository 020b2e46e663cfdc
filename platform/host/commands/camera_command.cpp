// `pliant camera list`: prints the cameras that `--frames camera:` accepts.
#include "host/commands/command.hpp"
#include "host/io/failure.hpp"
#include "host/io/camera_module.hpp"

#if PLIANT_HAS_LIBCAMERA
#include "pliant/libcamera.hpp"
#endif

namespace pliant::host {

namespace {

int run_camera(const Args& args, Console& console) {
  if (args.operand(0) != "list") fail_usage("no such action: " + args.operand(0) + "; there is list");
#if PLIANT_HAS_LIBCAMERA
  std::vector<CameraInfo> cameras;
  std::string wrong;
  const CameraModule* const module = load_camera_module(&wrong);
  if (module == nullptr) throw Failure(kBadInput, wrong);
  if (module->list(&cameras) != Status::ok) throw Failure(kBadInput, "libcamera does not start");
  if (cameras.empty()) throw Failure(kBadInput, "no camera");
  for (std::size_t k = 0; k < cameras.size(); ++k)
    console.out << k << "\t" << cameras[k].id << "\t" << cameras[k].model << "\n";
  return 0;
#else
  static_cast<void>(console);
  throw Failure(kBadInput, "this program was built without libcamera");
#endif
}

}  // namespace

Command camera_command() {
  return {"camera", "Lists the cameras: index, id and model, separated by tabs.", "list", {}, 1, run_camera};
}

}  // namespace pliant::host
