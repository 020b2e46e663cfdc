// Reads a video of any format through the ffmpeg program.
#include <cstdio>
#include <string>
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

}  // namespace

OpenedFrames open_video(const std::string& path) {
  // "file:" makes a name with a colon or a leading dash a file's name, and the list of protocols keeps a playlist from opening
  // anything but files.
  // Each frame of the file once, also where their times are irregular; square pixels.
  const std::string square = "scale=if(gt(abs(sar-1)\\,0.001)\\,2*trunc(iw*sar/2+0.5)\\,iw):ih,setsar=1";
  const std::vector<std::string> input{"-v",        "repeat+error", "-protocol_whitelist",
                                       "file,pipe", "-i",           "file:" + path},
      frames{"-nostdin", "-map", "0:v:0?", "-vsync", "passthrough", "-vf", square},
      output{"-f", "yuv4mpegpipe", "-pix_fmt", "yuvj420p", "-strict", "-1", "-"};
  std::vector<std::string> words{"ffmpeg"};
  for (const auto& part : {input, frames, output}) words.insert(words.end(), part.begin(), part.end());
  auto ffmpeg = ChildProcess::start(words, ChildProcess::Pipe::from_output);
  if (ffmpeg == nullptr)
    return {
        nullptr,
        path + ": is no Y4M; the program ffmpeg would read it, but is not installed (apt install ffmpeg)"};
  return open_y4m_from(std::move(ffmpeg), path, mean_rate(input));
}

}  // namespace pliant::host
