#pragma once
// What the openers share.
#include <string>
#include <vector>

#include "host/io/frame_source.hpp"

namespace pliant::host {

/// These pictures, in this order; at least one. The first one's size is the size.
OpenedFrames open_pictures(std::vector<std::string> paths);

struct CameraSpec;
/// A camera, running; without libcamera in the build only the message that says so.
OpenedFrames open_camera(const CameraSpec& spec);

/// Whether a comes before b when runs of digits count as numbers.
bool is_naturally_before(const std::string& a, const std::string& b);

/// No picture may be larger than this, either way.
constexpr int kMaxFrameSide = 16384;

}  // namespace pliant::host
