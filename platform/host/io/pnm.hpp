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

/// The largest value that the header of such a picture tells. For any other, and for one that is cut off, `message` says what is
/// wrong.
int pnm_maximum(const std::string& bytes, std::string& message);
/// A value of a picture with this largest one, as one of 255.
std::uint8_t stretched(int value, int maximum);

}  // namespace pliant::host
