#include "host/io/frame_source.hpp"

#include <cstdio>
#include <filesystem>
#include <string_view>

#include "host/io/camera_spec.hpp"
#include "host/io/sources.hpp"
#include "host/io/words.hpp"

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

namespace {

/// Whether a file is empty or begins as Y4M does. Files that are no plain files (a named pipe) are not read twice, and count
/// as Y4M.
bool is_y4m(const std::string& path, std::filesystem::file_status status) {
  if (!std::filesystem::is_regular_file(status) || ends_with(in_lower_case(path), ".y4m")) return true;
  constexpr std::string_view kBeginning = "YUV4MPEG2";
  char bytes[kBeginning.size()] = {};
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (file == nullptr) return true;
  const std::size_t got = std::fread(bytes, 1, sizeof bytes, file);
  std::fclose(file);
  return got == 0 || std::string_view(bytes, got) == kBeginning;
}

}  // namespace

OpenedFrames open_frames(const std::string& name) {
  if (name == "-") return open_y4m(name);
  if (CameraSpec camera; parse_camera_spec(name, &camera)) return open_camera(camera);
  std::error_code error;
  const auto status = std::filesystem::status(name, error);
  if (status.type() == std::filesystem::file_type::not_found)
    return {nullptr, name + ": no such file or folder"};
  if (std::filesystem::is_directory(status)) return open_folder(name);
  if (has_picture_extension(name) && !is_animated_png(name)) return open_pictures({name});
  return is_y4m(name, status) ? open_y4m(name) : open_video(name);
}

}  // namespace pliant::host
