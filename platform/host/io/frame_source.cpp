#include "host/io/frame_source.hpp"

#include <filesystem>

#include "host/io/camera_spec.hpp"
#include "host/io/pnm.hpp"
#include "host/io/sources.hpp"

namespace pliant::host {

Status FrameSource::next(FrameView& frame) {
  if (status_ != Status::ok) return status_;
  FrameView next;
  next.width = width_;
  next.height = height_;
  next.stride_bytes = static_cast<std::size_t>(width_);
  next.sequence = index_;
  next.time_ns = static_cast<std::int64_t>(1e9 * index_ / rate_.per_second() + 0.5);
  status_ = read(index_, next);
  if (status_ != Status::ok) return status_;
  frame = next;
  ++index_;
  return Status::ok;
}

OpenedFrames open_frames(const std::string& name) {
  if (name == "-") return open_y4m(name);
  if (CameraSpec camera; parse_camera_spec(name, &camera)) return open_camera(camera);
  std::error_code error;
  const auto status = std::filesystem::status(name, error);
  if (status.type() == std::filesystem::file_type::not_found)
    return {nullptr, name + ": no such file or folder"};
  if (std::filesystem::is_directory(status)) return open_folder(name);
  if (has_pnm_extension(name)) return open_pictures({name});
  return open_y4m(name);
}

}  // namespace pliant::host
