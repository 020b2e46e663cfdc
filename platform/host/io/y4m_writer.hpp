#pragma once
/// \file y4m_writer.hpp
/// Writes a Y4M file that players and ffmpeg read: grey, or colour as YUV 4:2:0 (BT.601, full range, and
/// marked so).
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "host/io/frame_source.hpp"

namespace pliant::host {

class Y4mWriter {
 public:
  enum class Colour { mono, yuv420 };

  Y4mWriter() = default;
  ~Y4mWriter();
  Y4mWriter(const Y4mWriter&) = delete;
  Y4mWriter& operator=(const Y4mWriter&) = delete;

  /// Creates the file (or takes standard output for "-") and writes its header. `bad_argument` for an
  /// impossible size or rate, or if one is open already; `io_error` with message() otherwise.
  Status open(const std::string& path, int width, int height, FrameRate rate, Colour colour);
  /// Appends a grey frame: width * height bytes. In a colour file its chroma is neutral.
  Status write_luma(const std::uint8_t* luma);
  /// Appends a colour frame: red, green, blue, interleaved, 3 * width * height bytes. In a grey file its
  /// luma.
  Status write_rgb(const std::uint8_t* rgb);
  /// Flushes and closes. `io_error` if anything did not reach the file.
  Status close();

  const std::string& message() const { return message_; }

 private:
  Status write_frame();
  Status fail();
  void set_chroma(const std::uint8_t* rgb);

  std::FILE* file_ = nullptr;
  std::string name_, message_;
  int width_ = 0, height_ = 0;
  Colour colour_ = Colour::mono;
  std::vector<std::uint8_t> frame_;  // luma, then both chroma planes
};

}  // namespace pliant::host
