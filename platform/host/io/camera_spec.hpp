#pragma once
// "camera:" as the name of a source of frames.
#include <string>

namespace pliant::host {

/// What stands behind "camera:": [ID or INDEX][@WxH].
struct CameraSpec {
  std::string camera;  ///< empty: the first one
  int width = 640, height = 480;
};

/// Whether `name` starts with "camera:", and then what it says. An id may contain any character; only a final "@WxH" with
/// two numbers from 16 to 8192 is a size.
bool parse_camera_spec(const std::string& name, CameraSpec* spec);

}  // namespace pliant::host
