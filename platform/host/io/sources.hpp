#pragma once
// Functions that open the kinds of frame sources.
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "host/io/frame_source.hpp"

namespace pliant::host {

/// Opens these pictures, at least one, in this order. All must have the size of the first.
OpenedFrames open_pictures(std::vector<std::string> paths);

/// Whether a name ends as that of a picture: .png, .jpg, .jpeg, .pgm, .ppm or .pnm, in any case.
bool has_picture_extension(const std::string& path);

/// Whether an entry of a folder is a picture that is read with the folder: by its ending, a file, and not hidden.
bool is_picture_of_folder(const std::filesystem::directory_entry& entry);
/// Whether a folder that is read has this as a file: not a hidden one, which some systems put beside others and which holds
/// something else, and no pipe, which would be waited for. A link to nothing is a file that is missing.
bool is_file_of_folder(const std::filesystem::directory_entry& entry);
/// Paths of the pictures of a folder, ordered by name. \param error  out: why the folder cannot be read.
std::vector<std::string> pictures_in(const std::string& folder, std::error_code& error);

/// Whether a file is a PNG with several frames (APNG), which is a video whatever its name.
bool is_animated_png(const std::string& path);
/// Opens a video file through the ffmpeg program, the first video track in it.
OpenedFrames open_video(const std::string& path);
class ChildProcess;
/// Opens the Y4M stream that a program writes. `name` names it in messages. \param tags  of a Y4M header, each after a space, that
/// count instead of the stream's own.
OpenedFrames open_y4m_from(std::unique_ptr<ChildProcess> program, const std::string& name,
                           const std::string& tags);
/// The tag of the matrix of a stream's colours, before ffmpeg's name of that (ours: ffmpeg writes none).
constexpr char kMatrixTag[] = "XMATRIX=";

struct CameraSpec;
/// Opens and starts a camera. Without libcamera in the build it returns an error.
OpenedFrames open_camera(const CameraSpec& spec);

/// Whether a comes before b when runs of digits count as numbers.
bool is_naturally_before(const std::string& a, const std::string& b);

/// Largest width and height of a frame, px.
constexpr int kMaxFrameSide = 16384;

}  // namespace pliant::host
