// Reads a video of any format through the ffmpeg program.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/io/child_process.hpp"
#include "host/io/numbers.hpp"
#include "host/io/sources.hpp"

namespace pliant::host {

namespace {

/// n / d frames a second; 0 where it is unknown.
struct Rate {
  long long n = 0, d = 0;
  double per_second() const { return d > 0 ? static_cast<double>(n) / static_cast<double>(d) : 0; }
};

/// As a Y4M header has it, n:d; empty if it can have no such rate.
std::string rate_text(Rate rate) {
  constexpr int kMost = 999'999'999;  // nine digits are read
  for (; rate.n > kMost || rate.d > kMost; rate.d /= 10) rate.n /= 10;
  const bool is_possible = rate.per_second() >= 1e-3 && rate.per_second() <= 1e6;
  return is_possible ? std::to_string(rate.n) + ":" + std::to_string(rate.d) : "";
}

/// Packets of a file that are read for their times: 11 minutes of 30 a second, for which ffprobe takes less than a second.
constexpr int kMostPackets = 20'000;

/// The times of a video's packets, in their order in the file.
class PacketTimes {
 public:
  /// \param time_s  nothing where a packet has no time.
  void add(std::optional<double> time_s) {
    ++packets_;
    // B-frames step back by a few frames; by more than a second a clock that begins anew, as in joined recordings.
    is_usable_ = is_usable_ && time_s && *time_s > last_shown_ - 1;
    // VP8 has pictures for reference that are not shown; they have the time of the frame before.
    if (!is_usable_ || *time_s == before_) return;
    first_shown_ = std::min(first_shown_, *time_s);
    last_shown_ = std::max(last_shown_, *time_s);
    before_ = *time_s;
    ++frames_;
  }
  bool is_all() const { return packets_ < kMostPackets; }
  Rate mean() const {
    if (!is_usable_ || frames_ < 2) return {};
    return {(frames_ - 1) * 1'000'000, std::llround((last_shown_ - first_shown_) * 1e6)};
  }

 private:
  int packets_ = 0;
  long long frames_ = 0;
  double first_shown_ = HUGE_VAL, last_shown_ = -HUGE_VAL, before_ = -HUGE_VAL;  // s
  bool is_usable_ = true;
};

/// Tags of a Y4M header with what the program ffprobe, which comes with ffmpeg, tells: frames a second in the mean, and the matrix
/// of the colours. Of irregular times ffmpeg writes the smallest distance into the Y4M header, and many containers state a rate
/// that is none of theirs; the matrix it leaves as it is, and does not write.
/// \param file  the program's standard input.
std::string probed_tags(const std::vector<std::string>& input, const std::string& file) {
  std::vector<std::string> words{"ffprobe"};
  words.insert(words.end(), input.begin(), input.end());
  words.insert(
      words.end(),
      {"-select_streams", "v:0", "-read_intervals", "%+#" + std::to_string(kMostPackets), "-show_entries",
       "packet=pts_time:stream=avg_frame_rate,nb_frames,color_space", "-of", "default=nw=1"});
  const auto ffprobe = ChildProcess::start(words, ChildProcess::Pipe::from_output, file);
  if (ffprobe == nullptr) return "";
  PacketTimes times;
  Rate stated;
  long long counted = 0;  // frames, where the container has an index
  std::string tags;
  for (char line[64]; std::fgets(line, sizeof line, ffprobe->stream()) != nullptr;) {
    char time[32], space[32];
    if (std::sscanf(line, "pts_time=%31s", time) == 1) times.add(parse_number(time));
    std::sscanf(line, "avg_frame_rate=%lld/%lld", &stated.n, &stated.d);
    std::sscanf(line, "nb_frames=%lld", &counted);
    if (std::sscanf(line, "color_space=%31s", space) == 1) tags = std::string(" ") + kMatrixTag + space;
  }
  const Rate mean = times.mean();
  // Times in milliseconds, or of a recorder's clock, give a constant rate to about this.
  constexpr double kRelativeError = 0.01;
  const bool agrees = std::abs(stated.per_second() - mean.per_second()) <= kRelativeError * mean.per_second();
  const bool is_of_index = counted > 0 && !times.is_all();
  const std::string rate = rate_text(mean.d == 0 || agrees || is_of_index ? stated : mean);
  return rate.empty() ? tags : tags + " F" + rate;
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
  // In the name of a picture ffmpeg takes %d for the numbers of many, and would read those: there the file is standard input.
  const bool has_percent = path.find('%') != std::string::npos;
  const std::string file = has_percent ? path : "/dev/null";
  input.insert(input.end(), {"-i", "file:" + (has_percent ? "/dev/stdin" : path)});
  const std::vector<std::string> frames{"-nostdin", "-map", "0:v:0?", "-vsync", "passthrough", "-vf", square},
      output{"-f", "yuv4mpegpipe", "-pix_fmt", "yuvj420p", "-strict", "-1", "-"};
  std::vector<std::string> words{"ffmpeg"};
  for (const auto& part : {input, frames, output}) words.insert(words.end(), part.begin(), part.end());
  auto ffmpeg = ChildProcess::start(words, ChildProcess::Pipe::from_output, file);
  if (ffmpeg == nullptr)
    return {
        nullptr,
        path + ": is no Y4M; the program ffmpeg would read it, but is not installed (apt install ffmpeg)"};
  OpenedFrames opened = open_y4m_from(std::move(ffmpeg), path, probed_tags(input, file));
  if (opened.source == nullptr && is_animated_webp(path))
    opened.message =
        path + ": is an animated WebP, which this ffmpeg does not read; convert it, to GIF for example";
  return opened;
}

}  // namespace pliant::host
