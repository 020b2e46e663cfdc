#pragma once
// Reads binary PGM (P5) and PPM (P6) of eight bits as luma.
#include <cstdint>
#include <string>
#include <vector>

#include "host/io/image.hpp"
#include "pliant/status.hpp"

namespace pliant::host {

struct LumaPicture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;  ///< rows without padding
  Image colour;                      ///< what a PPM holds beyond luma; empty for a PGM
};

/// Reads a picture. Colour becomes luma (BT.601: 0.299 R + 0.587 G + 0.114 B, rounded). If the header has a maximum below 255,
/// values are scaled to 255, those of the colour, too. Otherwise `io_error` or `truncated`, and `message` names the file and the
/// error.
Status read_pnm(const std::string& path, LumaPicture& picture, std::string& message);

/// The picture in the bytes of such a file, in three channels, also one of grey. Otherwise `message` says what is wrong.
Image pnm_in(const std::string& bytes, std::string& message);

}  // namespace pliant::host
