#include "frames/frame_source.hpp"

#include <filesystem>

#include "frames/pnm.hpp"
#include "frames/sources.hpp"

namespace pliant {

Status FrameSource::next(FrameView& frame) {
  if (status_ != Status::ok) return status_;
  const std::uint8_t* luma = nullptr;
  status_ = read(index_, luma);
  if (status_ != Status::ok) return status_;
  frame = FrameView{};
  frame.data = luma;
  frame.width = width_;
  frame.height = height_;
  frame.stride_bytes = static_cast<std::size_t>(width_);
  frame.sequence = index_;
  frame.time_ns = static_cast<std::int64_t>(1e9 * index_ / rate_.per_second() + 0.5);
  ++index_;
  return Status::ok;
}

OpenedFrames open_frames(const std::string& name) {
  if (name == "-") return open_y4m(name);
  std::error_code error;
  const auto status = std::filesystem::status(name, error);
  if (status.type() == std::filesystem::file_type::not_found)
    return {nullptr, name + ": no such file or folder"};
  if (std::filesystem::is_directory(status)) return open_folder(name);
  if (has_pnm_extension(name)) return open_pictures({name});
  return open_y4m(name);
}

}  // namespace pliant
