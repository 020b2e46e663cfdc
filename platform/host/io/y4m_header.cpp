#include "host/io/y4m_header.hpp"

#include <cctype>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <sstream>

#include "host/io/sources.hpp"

namespace pliant::host {
namespace {

// A plain number of at most nine digits, all of the text; -1 otherwise.
int number_of(const std::string& text) {
  if (text.empty() || text.size() > 9) return -1;
  int value = 0;
  for (const char c : text) {
    if (std::isdigit(static_cast<unsigned char>(c)) == 0) return -1;
    value = 10 * value + (c - '0');
  }
  return value;
}

bool parse_rate(const std::string& text, FrameRate& rate) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) return false;
  const int n = number_of(text.substr(0, colon)), d = number_of(text.substr(colon + 1));
  if (n < 0 || d < 0) return false;
  rate = n == 0 || d == 0 ? FrameRate{} : FrameRate{n, d};
  constexpr double kLeast = 1e-3, kMost = 1e6;  // frames a second; keeps times within their type
  return rate.per_second() >= kLeast && rate.per_second() <= kMost;
}

// Whether the ratio of a pixel's sides is 1 to within a thousandth, as a change of size leaves it, or unknown (0:0).
bool are_square(const std::string& ratio) {
  const std::size_t colon = ratio.find(':');
  if (colon == std::string::npos) return false;
  const int across = number_of(ratio.substr(0, colon)), down = number_of(ratio.substr(colon + 1));
  return across >= 0 && down >= 0 && std::abs(std::int64_t{1000} * (across - down)) <= down;
}

// Sets step, size and bytes of the chroma planes (and alpha) for a colour space of eight bits. False for any other.
bool set_chroma(Y4mHeader& h) {
  const std::string& c = h.chroma;
  int across = 1, down = 1;
  if (c == "420" || c == "420jpeg" || c == "420mpeg2" || c == "420paldv")
    across = down = 2;
  else if (c == "422" || c == "411")
    across = c == "422" ? 2 : 4;
  else if (c != "444" && c != "444alpha" && c != "mono")
    return false;
  h.chroma_step = {across, down};
  if (c != "mono") h.chroma_size = {(h.width + across - 1) / across, (h.height + down - 1) / down};
  const auto plane =
      static_cast<std::size_t>(h.chroma_size.width) * static_cast<std::size_t>(h.chroma_size.height);
  h.chroma_bytes = (c == "444alpha" ? 3 : 2) * plane;
  return true;
}

// By ffmpeg's name. Those of other names, and of none, count as BT.601, as ffmpeg takes them.
ColourMatrix matrix_of(const std::string& name) {
  if (name == "bt709") return {1575, -187, -468, 1856};
  if (name == "bt2020nc") return {1475, -165, -571, 1881};
  return {};
}

std::string wrong_side(const char* name, int value) {
  return std::string("its header says ") + name + " is " + std::to_string(value) + ", but a side is 1 to " +
         std::to_string(kMaxFrameSide);
}

}  // namespace

std::string parse_y4m_header(const std::string& line, Y4mHeader& h) {
  std::istringstream words(line);
  std::string word;
  words >> word;
  if (word != "YUV4MPEG2") return "not a Y4M stream (it does not start with YUV4MPEG2)";
  bool has_width = false, has_height = false;
  while (words >> word) {
    const std::string value = word.substr(1);
    if (word[0] == 'W' || word[0] == 'H') {
      const int n = number_of(value);
      if (n < 0) return "its header has no number in " + word;
      (word[0] == 'W' ? h.width : h.height) = n;
      (word[0] == 'W' ? has_width : has_height) = true;
    } else if (word[0] == 'F') {
      if (!parse_rate(value, h.rate)) return "its header has no possible frame rate in " + word;
    } else if (word[0] == 'C') {
      h.chroma = value;
    } else if (word == "XCOLORRANGE=LIMITED") {
      h.is_limited = true;
    } else if (word.rfind(kMatrixTag, 0) == 0) {
      h.matrix = matrix_of(word.substr(std::strlen(kMatrixTag)));
    } else if (word[0] == 'A') {
      if (!are_square(value))
        return "its pixels are not square (" + word +
               "); ffmpeg -i IN -vf \"scale=iw*sar:ih,setsar=1\" OUT makes them so";
    }
  }
  if (!has_width) return "its header has no width (W)";
  if (!has_height) return "its header has no height (H)";
  if (h.width < 1 || h.width > kMaxFrameSide) return wrong_side("the width", h.width);
  if (h.height < 1 || h.height > kMaxFrameSide) return wrong_side("the height", h.height);
  h.luma_bytes = static_cast<std::size_t>(h.width) * static_cast<std::size_t>(h.height);
  if (!set_chroma(h))
    return "its colour space C" + h.chroma +
           " is not one that is read: mono, 420, 422, 411 or 444 of eight bits";
  return {};
}

}  // namespace pliant::host
