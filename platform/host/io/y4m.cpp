// Reads a Y4M file or pipe as luma frames.
#include <sys/stat.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <vector>

#include "host/io/child_process.hpp"
#include "host/io/sources.hpp"
#include "host/io/y4m_header.hpp"

namespace pliant::host {
namespace {

constexpr std::size_t kMaxLine = 4096;  // longest accepted header, bytes

// A file, standard input, or the output of a program. Only a file is closed here.
class Stream {
 public:
  Stream(std::FILE* file, std::string name) : file_(file), name_(std::move(name)) {}
  Stream(std::unique_ptr<ChildProcess> program, std::string name)
      : program_(std::move(program)), file_(program_->stream()), name_(std::move(name)) {}
  ~Stream() {
    if (file_ != stdin && program_ == nullptr) std::fclose(file_);
  }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  // Reads up to a line feed, which is dropped. `is_whole` is false if the data end before it or the line is too long.
  std::string line(bool& is_whole) {
    std::string text;
    int c = std::fgetc(file_);
    for (; c != '\n' && c != EOF && text.size() < kMaxLine; c = std::fgetc(file_))
      text.push_back(static_cast<char>(c));
    is_whole = c == '\n';
    return text;
  }
  // Reads up to n bytes in pieces, so that a wrong size in a header does not allocate memory.
  std::size_t read(std::vector<std::uint8_t>& out, std::size_t n) {
    constexpr std::size_t kPiece = std::size_t{1} << 20;
    std::size_t have = 0;
    while (have < n) {
      const std::size_t want = n - have < kPiece ? n - have : kPiece;
      if (out.size() < have + want) out.resize(have + want);
      const std::size_t got = std::fread(out.data() + have, 1, want, file_);
      have += got;
      if (got < want) break;
    }
    return have;
  }
  // From here to the end, if this is a plain file; else 0.
  std::size_t bytes_left() const {
    struct stat status {};
    if (fstat(fileno(file_), &status) != 0 || !S_ISREG(status.st_mode)) return 0;
    const auto size = static_cast<std::int64_t>(status.st_size), at = std::int64_t{std::ftell(file_)};
    return at < 0 || at > size ? 0 : static_cast<std::size_t>(size - at);
  }
  bool has_failed() const { return std::ferror(file_) != 0; }
  const std::string& name() const { return name_; }
  // At the end of the data: what a program says of its failure, or of a file that is cut off, for which it does not fail; empty
  // otherwise.
  std::string why_it_ended() {
    if (program_ == nullptr) return "";
    std::string why = program_->finish();
    for (const char* of_ffmpeg : {"ended prematurely", "partial file"})  // in Matroska; in MP4
      if (why.empty()) why = program_->last_error(of_ffmpeg);
    return why;
  }
  // What a program has said last, whether it failed or not.
  std::string last_error() { return program_ == nullptr ? "" : program_->last_error(); }

 private:
  std::unique_ptr<ChildProcess> program_;
  std::FILE* file_;
  std::string name_;
};

// Red, green and blue from luma and the two chroma values, whose middle is 0.
void set_colour(const ColourMatrix& m, int y, int cb, int cr, std::uint8_t* rgb) {
  const auto byte = [](int thousandths) {
    return static_cast<std::uint8_t>(thousandths < 0        ? 0
                                     : thousandths > 255000 ? 255
                                                            : (thousandths + 500) / 1000);
  };
  rgb[0] = byte(1000 * y + m.red_of_cr * cr);
  rgb[1] = byte(1000 * y + m.green_of_cb * cb + m.green_of_cr * cr);
  rgb[2] = byte(1000 * y + m.blue_of_cb * cb);
}

// The values of a limited range (BT.601), in which black is `low` and there are `steps` to the end, as those of the full one.
void expand(std::vector<std::uint8_t>& plane, int low, int steps, int low_of_full) {
  std::uint8_t full[256];
  for (int v = 0; v < 256; ++v) {
    const int of_full = low_of_full + ((v - low) * 510 + (v < low ? -steps : steps)) / (2 * steps);
    full[v] = static_cast<std::uint8_t>(of_full < 0 ? 0 : of_full > 255 ? 255 : of_full);
  }
  for (std::uint8_t& v : plane) v = full[v];
}

class Y4mSource : public FrameSource {
 public:
  Y4mSource(std::unique_ptr<Stream> stream, const Y4mHeader& header)
      : stream_(std::move(stream)), header_(header) {
    width_ = header.width;
    height_ = header.height;
    rate_ = header.rate;
    constexpr std::size_t kFrameLine = 6;  // "FRAME" without tags
    count_ = stream_->bytes_left() / (kFrameLine + header.luma_bytes + header.chroma_bytes);
  }

  Image colour() const override {
    const ImageSize &size = header_.chroma_size, &step = header_.chroma_step;
    if (size.width == 0) return {};
    Image out(width_, height_, 3);
    const std::uint8_t* y = luma_.data();
    const auto plane = static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
    for (int j = 0; j < height_; ++j)
      for (int i = 0; i < width_; ++i, ++y) {
        const auto at = static_cast<std::size_t>(j / step.height) * static_cast<std::size_t>(size.width) +
                        static_cast<std::size_t>(i / step.width);
        set_colour(header_.matrix, *y, chroma_[at] - 128, chroma_[plane + at] - 128, out.at(i, j));
      }
    return out;
  }

 private:
  Status read(std::uint32_t index, FrameView& frame) override {
    bool is_whole = false;
    const std::string line = stream_->line(is_whole);
    if (stream_->has_failed()) return fail(Status::io_error, at(index) + ": " + std::strerror(errno));
    if (line.empty() && !is_whole) {
      const std::string why = stream_->why_it_ended(), said = stream_->last_error();
      if (!why.empty()) return fail(Status::truncated, at(index) + ": ffmpeg: " + why);
      if (!said.empty()) note_ = stream_->name() + ": was read to its end, though ffmpeg says: " + said;
      return Status::end_of_stream;
    }
    const bool is_frame = line.compare(0, 5, "FRAME") == 0 && (line.size() == 5 || line[5] == ' ');
    if (!is_whole && (is_frame || std::string("FRAME").compare(0, line.size(), line) == 0))
      return cut(index, (line.size() < 6 ? 6 - line.size() : 1) + header_.luma_bytes + header_.chroma_bytes);
    if (!is_frame || !is_whole)
      return fail(Status::io_error, at(index) + ": no FRAME where one must start; is its size not " +
                                        std::to_string(width_) + "x" + std::to_string(height_) + "?");
    if (const Status s = read_plane(index, luma_, header_.luma_bytes, header_.chroma_bytes); s != Status::ok)
      return s;
    if (const Status s = read_plane(index, chroma_, header_.chroma_bytes, 0); s != Status::ok) return s;
    if (header_.is_limited) {
      expand(luma_, 16, 219, 0);
      expand(chroma_, 128, 224, 128);
    }
    frame.data = luma_.data();
    return Status::ok;
  }

  // `after`: bytes of the frame after this plane, for the message.
  Status read_plane(std::uint32_t index, std::vector<std::uint8_t>& plane, std::size_t bytes,
                    std::size_t after) {
    const std::size_t got = stream_->read(plane, bytes);
    if (got == bytes) return Status::ok;
    if (stream_->has_failed()) return fail(Status::io_error, at(index) + ": " + std::strerror(errno));
    return cut(index, bytes - got + after);
  }
  Status cut(std::uint32_t index, std::size_t missing) {
    return fail(Status::truncated,
                at(index) + " is cut off: " + std::to_string(missing) + " bytes are missing");
  }
  std::string at(std::uint32_t index) const { return stream_->name() + ": frame " + std::to_string(index); }

  std::unique_ptr<Stream> stream_;
  Y4mHeader header_;
  std::vector<std::uint8_t> luma_, chroma_;
};

OpenedFrames open_stream(std::unique_ptr<Stream> stream, const std::string& tags = "") {
  const std::string& name = stream->name();
  bool is_whole = false;
  const std::string line = stream->line(is_whole);
  if (stream->has_failed()) return {nullptr, name + ": " + std::strerror(errno)};
  if (line.empty() && !is_whole) {
    const std::string failure = stream->why_it_ended(),
                      why = failure.empty() ? stream->last_error() : failure;
    return {nullptr, name + (why.empty() ? ": is empty" : ": cannot be read as a video: " + why)};
  }
  Y4mHeader header;
  // Of tags of a kind the last one counts.
  if (const std::string wrong = parse_y4m_header(line + tags, header); !wrong.empty())
    return {nullptr, name + ": " + wrong};
  if (!is_whole) return {nullptr, name + ": ends, or goes on without end, in its first line"};
  return {std::make_unique<Y4mSource>(std::move(stream), header), {}};
}

}  // namespace

OpenedFrames open_y4m(const std::string& path) {
  const std::string name = path == "-" ? "standard input" : path;
  std::FILE* const file = path == "-" ? stdin : std::fopen(path.c_str(), "rb");
  if (file == nullptr) return {nullptr, name + ": " + std::strerror(errno)};
  return open_stream(std::make_unique<Stream>(file, name));
}

OpenedFrames open_y4m_from(std::unique_ptr<ChildProcess> program, const std::string& name,
                           const std::string& tags) {
  return open_stream(std::make_unique<Stream>(std::move(program), name), tags);
}

}  // namespace pliant::host
