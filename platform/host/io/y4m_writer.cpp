#include "host/io/y4m_writer.hpp"

#include <cerrno>
#include <cstring>

#include "host/io/sources.hpp"

namespace pliant::host {
namespace {

struct Sum {
  int r = 0, g = 0, b = 0;
};

// Sum of the 2 x 2 pixels at (x, y), the last row and column repeated where the size is odd.
Sum sum_of_block(const std::uint8_t* rgb, int width, int height, int x, int y) {
  Sum s;
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const int px = x + i < width ? x + i : width - 1, py = y + j < height ? y + j : height - 1;
      const std::uint8_t* p = rgb + 3 * (static_cast<std::ptrdiff_t>(py) * width + px);
      s.r += p[0];
      s.g += p[1];
      s.b += p[2];
    }
  return s;
}

// 128 + sum / 4 for weights in thousandths; the sum is within +-127.5 * 4.
std::uint8_t chroma(int weighted) {
  const int v = (weighted + 4 * 128 * 1000 + 2000) / 4000;
  return static_cast<std::uint8_t>(v > 255 ? 255 : v);
}

}  // namespace

Y4mWriter::~Y4mWriter() {
  if (file_ != nullptr && file_ != stdout) std::fclose(file_);
}

Status Y4mWriter::fail() {
  message_ = name_ + ": " + std::strerror(errno);
  return Status::io_error;
}

Status Y4mWriter::open(const std::string& path, int width, int height, FrameRate rate, Colour colour) {
  if (file_ != nullptr || width < 1 || height < 1 || width > kMaxFrameSide || height > kMaxFrameSide ||
      rate.numerator < 1 || rate.denominator < 1)
    return Status::bad_argument;
  name_ = path == "-" ? "standard output" : path;
  file_ = path == "-" ? stdout : std::fopen(path.c_str(), "wb");
  if (file_ == nullptr) return fail();
  width_ = width;
  height_ = height;
  colour_ = colour;
  const auto luma = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  const auto quarter = static_cast<std::size_t>((width + 1) / 2) * static_cast<std::size_t>((height + 1) / 2);
  frame_.assign(luma + (colour == Colour::mono ? 0 : 2 * quarter), 128);
  const char* const space = colour == Colour::mono ? "mono" : "420jpeg";
  const int written = std::fprintf(file_, "YUV4MPEG2 W%d H%d F%d:%d Ip A1:1 C%s XCOLORRANGE=FULL\n", width,
                                   height, rate.numerator, rate.denominator, space);
  return written > 0 ? Status::ok : fail();
}

Status Y4mWriter::write_frame() {
  if (file_ == nullptr) return Status::not_ready;
  const bool is_written = std::fputs("FRAME\n", file_) >= 0 &&
                          std::fwrite(frame_.data(), 1, frame_.size(), file_) == frame_.size();
  return is_written ? Status::ok : fail();
}

Status Y4mWriter::write_luma(const std::uint8_t* luma) {
  const auto n = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  if (file_ == nullptr) return Status::not_ready;
  std::memcpy(frame_.data(), luma, n);
  if (colour_ == Colour::yuv420) std::memset(frame_.data() + n, 128, frame_.size() - n);
  return write_frame();
}

Status Y4mWriter::write_rgb(const std::uint8_t* rgb) {
  if (file_ == nullptr) return Status::not_ready;
  const auto n = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint8_t* p = rgb + 3 * i;
    frame_[i] = static_cast<std::uint8_t>((299 * p[0] + 587 * p[1] + 114 * p[2] + 500) / 1000);
  }
  if (colour_ == Colour::yuv420) set_chroma(rgb);
  return write_frame();
}

// Cb = -0.168736 R - 0.331264 G + 0.5 B and Cr = 0.5 R - 0.418688 G - 0.081312 B, of the mean of 2 x 2
// pixels.
void Y4mWriter::set_chroma(const std::uint8_t* rgb) {
  const int cw = (width_ + 1) / 2, ch = (height_ + 1) / 2;
  std::uint8_t* cb = frame_.data() + static_cast<std::ptrdiff_t>(width_) * height_;
  std::uint8_t* cr = cb + static_cast<std::ptrdiff_t>(cw) * ch;
  for (int y = 0; y < ch; ++y)
    for (int x = 0; x < cw; ++x) {
      const Sum s = sum_of_block(rgb, width_, height_, 2 * x, 2 * y);
      *cb++ = chroma(-169 * s.r - 331 * s.g + 500 * s.b);
      *cr++ = chroma(500 * s.r - 419 * s.g - 81 * s.b);
    }
}

Status Y4mWriter::close() {
  if (file_ == nullptr) return Status::not_ready;
  std::FILE* const file = file_;
  file_ = nullptr;
  const bool is_flushed = std::fflush(file) == 0 && std::ferror(file) == 0;
  const bool is_closed = file == stdout || std::fclose(file) == 0;
  return is_flushed && is_closed ? Status::ok : fail();
}

}  // namespace pliant::host
