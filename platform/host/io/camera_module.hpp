#pragma once
// Camera support as a library that is loaded only when a camera is used, because libcamera adds twenty libraries and 8 MB.
#include <string>
#include <vector>

#include "host/io/sources.hpp"

namespace pliant {
struct CameraInfo;
}

namespace pliant::host {

/// The functions of that library; it exports them as `pliant_camera_module`.
struct CameraModule {
  OpenedFrames (*open)(const CameraSpec& spec);
  Status (*list)(std::vector<CameraInfo>* cameras);
};

/// Loads the library once. Null, with the reason in `wrong`, if there is none.
const CameraModule* load_camera_module(std::string* wrong);

}  // namespace pliant::host
