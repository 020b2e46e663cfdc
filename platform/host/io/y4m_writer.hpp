#pragma once
/// \file y4m_writer.hpp
/// Writes a Y4M file that players and ffmpeg read: grey, or colour as YUV 4:2:0 (BT.601, full range, and
/// marked so).
#include <memory>
#include <string>

#include "host/io/child_process.hpp"
#include "host/io/files.hpp"
#include "host/io/frame_source.hpp"
#include "host/io/image.hpp"

namespace pliant::host {

/// Writes pictures of one size, all grey or all colour as the first one. The file gets its name in `commit`.
class Y4mWriter {
 public:
  /// \param path  a file, or "-" for standard output. Bad input if it cannot be created.
  Y4mWriter(const std::string& path, FrameRate rate) : file_(path), rate_(rate) {}
  /// Writes to a program, which messages call `name`.
  Y4mWriter(std::unique_ptr<ChildProcess> program, const std::string& name, FrameRate rate)
      : file_(std::move(program), name), rate_(rate) {}

  /// Appends a frame. Bad input: another size than the first one's, a size outside 1 to 16384 pixels a side, or a failed
  /// write.
  void write(const Image& image);
  void commit() { file_.commit(); }
  /// As of OutputFile.
  std::string end_program() { return file_.end_program(); }

 private:
  void begin(const Image& first);
  void set_chroma(const Image& image);

  OutputFile file_;
  FrameRate rate_;
  ImageSize size_{0, 0};
  bool is_grey_ = true;
  std::string frame_;  // luma, then both chroma planes
};

}  // namespace pliant::host
