#pragma once
// Parses "camera:..." as the name of a frame source.
#include <string>

namespace pliant::host {

/// The text after "camera:": [ID or INDEX][@WxH].
struct CameraSpec {
  std::string camera;  ///< empty: the first one
  int width = 640, height = 480;
};

/// Returns whether `name` starts with "camera:", and if so parses it. An id may contain any character; only a final "@WxH" with
/// two numbers from 16 to 8192 is a size.
bool parse_camera_spec(const std::string& name, CameraSpec* spec);

}  // namespace pliant::host
