#pragma once
// Parses the first line of a Y4M stream.
#include <cstddef>
#include <string>

#include "host/io/frame_source.hpp"
#include "host/io/image.hpp"

namespace pliant::host {

/// What red, green and blue get from chroma, thousandths. BT.601's, as of JPEG.
struct ColourMatrix {
  int red_of_cr = 1402, green_of_cb = -344, green_of_cr = -714, blue_of_cb = 1772;
};

struct Y4mHeader {
  int width = 0, height = 0;
  FrameRate rate;
  std::string chroma = "420";  ///< the value of C
  bool is_limited = false;     ///< values are of 16 to 235, and of 16 to 240 for chroma
  ColourMatrix matrix;
  ImageSize chroma_step{1, 1};                   ///< pixels to a sample of chroma
  ImageSize chroma_size;                         ///< of each of the two chroma planes; 0 x 0 for grey
  std::size_t luma_bytes = 0, chroma_bytes = 0;  ///< of one frame; chroma: everything after luma
};

/// Reads "YUV4MPEG2 W320 H240 F25:1 ...", without its line feed. Interlacing and unknown tags are ignored, and X tags but for those
/// of a limited range and of a matrix; pixels that are not square are an error; a missing or zero rate is 25. Returns the error;
/// empty on success.
std::string parse_y4m_header(const std::string& line, Y4mHeader& header);

}  // namespace pliant::host
