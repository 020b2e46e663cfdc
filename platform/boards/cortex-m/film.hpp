#pragma once
// A camera made of a file: what stands in for the sensor on a board that has none.
#include "board.h"
#include "camera_buffers.hpp"

/// Plays a grey Y4M file of a known size into the buffers, frame after frame.
class Film {
 public:
  Film(CameraBuffers& buffers, int width, int height, std::int64_t frame_ns)
      : buffers_(buffers),
        bytes_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)),
        frame_ns_(frame_ns) {}

  bool open(const char* path) {
    file_ = board_open(path);
    return file_ >= 0 && skip_line();
  }

  /// What the DMA and its interrupt do. False at the end of the film.
  bool expose() {
    if (!skip_line() || board_read(file_, buffers_.filling(), bytes_) != bytes_) return false;
    buffers_.on_frame_complete(frame_ns_ * frame_++);
    return true;
  }

 private:
  /// A header ends with its line.
  bool skip_line() {
    char c = 0;
    for (int k = 0; k < 200; ++k)
      if (board_read(file_, &c, 1) != 1 || c == '\n') break;
    return c == '\n';
  }

  CameraBuffers& buffers_;
  std::size_t bytes_;
  std::int64_t frame_ns_;
  int file_ = -1, frame_ = 0;
};
