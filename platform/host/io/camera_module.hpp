#pragma once
// The command's cameras are a library of their own, loaded when one is asked for: libcamera brings twenty more libraries and
// 8 MB of memory.
#include <string>
#include <vector>

#include "host/io/sources.hpp"

namespace pliant {
struct CameraInfo;
}

namespace pliant::host {

/// What that library gives, under the name `pliant_camera_module`.
struct CameraModule {
  OpenedFrames (*open)(const CameraSpec& spec);
  Status (*list)(std::vector<CameraInfo>* cameras);
};

/// The library, loaded once and for good; null, with the reason, where there is none.
const CameraModule* load_camera_module(std::string* wrong);

}  // namespace pliant::host
