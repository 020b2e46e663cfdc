// Reads a video of any format through the ffmpeg program.
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "host/io/child_process.hpp"
#include "host/io/sources.hpp"

namespace pliant::host {

namespace {

/// Frames a second in the mean, n:d; empty if the program ffprobe, which comes with ffmpeg, does not tell. Of irregular times
/// ffmpeg writes the smallest distance into the Y4M header.
std::string mean_rate(const std::vector<std::string>& input) {
  std::vector<std::string> words{"ffprobe"};
  words.insert(words.end(), input.begin(), input.end());
  const std::vector<std::string> shown{"-select_streams",       "v:0", "-show_entries",
                                       "stream=avg_frame_rate", "-of", "default=nw=1:nk=1"};
  words.insert(words.end(), shown.begin(), shown.end());
  const auto ffprobe = ChildProcess::start(words, ChildProcess::Pipe::from_output);
  if (ffprobe == nullptr) return "";
  char line[64] = "";
  if (std::fgets(line, sizeof line, ffprobe->stream()) == nullptr) return "";
  int n = 0, d = 0;
  if (std::sscanf(line, "%d/%d", &n, &d) != 2 || n <= 0 || d <= 0) return "";
  for (constexpr int kMost = 999'999'999; n > kMost || d > kMost; d /= 10) n /= 10;  // nine digits are read
  const double rate = static_cast<double>(n) / d;
  if (!(rate >= 1e-3 && rate <= 1e6)) return "";  // as of a Y4M header
  return std::to_string(n) + ":" + std::to_string(d);
}

/// Null for anything else than a file: a pipe cannot be read twice.
std::FILE* open_regular(const std::string& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error) ? std::fopen(path.c_str(), "rb") : nullptr;
}

/// Whether a file is a WebP with several frames: an extended one whose flag for them is set.
bool is_animated_webp(const std::string& path) {
  std::FILE* const file = open_regular(path);
  if (file == nullptr) return false;
  char head[21] = {};
  const bool is_whole = std::fread(head, 1, sizeof head, file) == sizeof head;
  std::fclose(file);
  const std::string_view text(head, sizeof head);
  return is_whole && text.substr(0, 4) == "RIFF" && text.substr(8, 8) == "WEBPVP8X" && (head[20] & 2) != 0;
}

}  // namespace

bool is_animated_png(const std::string& path) {
  std::FILE* const file = open_regular(path);
  if (file == nullptr) return false;
  unsigned char head[8];  // of the file, then of a chunk: length and type
  bool is_known = false;
  std::string_view type = "head";
  // Frames are told by a chunk acTL before that of the first picture.
  while (type != "acTL" && type != "IDAT" && std::fread(head, 1, sizeof head, file) == sizeof head) {
    if (!is_known && std::memcmp(head, "\x89PNG\r\n\x1a\n", sizeof head) != 0) break;
    if (is_known) {
      type = {reinterpret_cast<const char*>(head) + 4, 4};
      const long bytes = long{head[0]} << 24 | long{head[1]} << 16 | long{head[2]} << 8 | long{head[3]};
      if (head[0] > 0x7f || std::fseek(file, bytes + 4, SEEK_CUR) != 0) break;  // the content and its sum
    }
    is_known = true;
  }
  std::fclose(file);
  return type == "acTL";
}

OpenedFrames open_video(const std::string& path) {
  // "file:" makes a name with a colon or a leading dash a file's name, and the list of protocols keeps a playlist from opening
  // anything but files.
  // Each frame of the file once, also where their times are irregular; square pixels.
  const std::string square = "scale=if(gt(abs(sar-1)\\,0.001)\\,2*trunc(iw*sar/2+0.5)\\,iw):ih,setsar=1";
  std::vector<std::string> input{"-v", "repeat+error", "-protocol_whitelist", "file,pipe"};
  // By the name .png ffmpeg would read the first frame alone.
  if (is_animated_png(path)) input.insert(input.end(), {"-f", "apng"});
  input.insert(input.end(), {"-i", "file:" + path});
  const std::vector<std::string> frames{"-nostdin", "-map", "0:v:0?", "-vsync", "passthrough", "-vf", square},
      output{"-f", "yuv4mpegpipe", "-pix_fmt", "yuvj420p", "-strict", "-1", "-"};
  std::vector<std::string> words{"ffmpeg"};
  for (const auto& part : {input, frames, output}) words.insert(words.end(), part.begin(), part.end());
  auto ffmpeg = ChildProcess::start(words, ChildProcess::Pipe::from_output);
  if (ffmpeg == nullptr)
    return {
        nullptr,
        path + ": is no Y4M; the program ffmpeg would read it, but is not installed (apt install ffmpeg)"};
  OpenedFrames opened = open_y4m_from(std::move(ffmpeg), path, mean_rate(input));
  if (opened.source == nullptr && is_animated_webp(path))
    opened.message =
        path + ": is an animated WebP, which this ffmpeg does not read; convert it, to GIF for example";
  return opened;
}

}  // namespace pliant::host
