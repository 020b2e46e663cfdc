#include "vision/thumbnail.hpp"

namespace pliant {

namespace {

void add_row(const std::uint8_t* __restrict row, int width, std::uint16_t* __restrict line) {
  for (int x = 0; x < width; ++x) line[x] = static_cast<std::uint16_t>(line[x] + row[x]);
}

}  // namespace

void make_thumbnail(const FrameView& frame, int factor, std::uint16_t* line, std::uint8_t* out) {
  const int across = frame.width / factor, down = frame.height / factor, width = across * factor;
  const int row_step = factor > 1 ? 2 : 1;
  const unsigned pixels = static_cast<unsigned>(factor * (factor / row_step));
  const std::uint8_t* rows = frame.data;
  for (int y = 0; y < down; ++y, rows += static_cast<std::size_t>(factor) * frame.stride_bytes) {
    for (int x = 0; x < width; ++x) line[x] = 0;
    for (int k = 0; k < factor; k += row_step) {
      const std::uint8_t* row = rows + static_cast<std::size_t>(k) * frame.stride_bytes;
      if (frame.pixel_step_bytes == 1) {
        add_row(row, width, line);
      } else {
        for (int x = 0; x < width; ++x)
          line[x] = static_cast<std::uint16_t>(line[x] + row[x * frame.pixel_step_bytes]);
      }
    }
    for (int x = 0; x < across; ++x) {
      unsigned sum = pixels / 2;
      for (int k = 0; k < factor; ++k) sum += line[x * factor + k];
      *out++ = static_cast<std::uint8_t>(sum / pixels);
    }
  }
}

}  // namespace pliant
