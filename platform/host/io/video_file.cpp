// Reads a video of any format through the ffmpeg program.
#include <string>
#include <vector>

#include "host/io/child_process.hpp"
#include "host/io/sources.hpp"

namespace pliant::host {

OpenedFrames open_video(const std::string& path) {
  // "file:" makes a name with a colon or a leading dash a file's name, and the list of protocols keeps a playlist from opening
  // anything but files.
  // Each frame of the file once, also where their times are irregular; square pixels.
  const std::string square = "scale=if(gt(abs(sar-1)\\,0.001)\\,2*trunc(iw*sar/2+0.5)\\,iw):ih,setsar=1";
  const std::vector<std::string> input{"-nostdin", "-v", "error", "-protocol_whitelist", "file,pipe",
                                       "-i", "file:" + path, "-map", "0:v:0?"},
      frames{"-vsync", "passthrough", "-vf", square},
      output{"-f", "yuv4mpegpipe", "-pix_fmt", "yuvj420p", "-strict", "-1", "-"};
  std::vector<std::string> words{"ffmpeg"};
  for (const auto& part : {input, frames, output}) words.insert(words.end(), part.begin(), part.end());
  auto ffmpeg = ChildProcess::start(words, ChildProcess::Pipe::from_output);
  if (ffmpeg == nullptr)
    return {
        nullptr,
        path + ": is no Y4M; the program ffmpeg would read it, but is not installed (apt install ffmpeg)"};
  return open_y4m_from(std::move(ffmpeg), path);
}

}  // namespace pliant::host
