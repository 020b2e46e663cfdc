#include "host/io/page.hpp"

#include "host/io/failure.hpp"
#include "host/io/files.hpp"
#include "host/io/jpeg_orientation.hpp"

namespace pliant::host {

namespace {

/// Quality of a JPEG that is turned, 1 to 100. Round value, not tuned: no loss that is seen.
constexpr int kTurnedQuality = 95;

/// A JPEG without its APP1 segments. A file that is cut off within its headers stays as it is.
std::string without_exif(const std::string& jpeg) {
  std::string out = jpeg.substr(0, 2);
  std::size_t at = 2;
  while (at + 4 <= jpeg.size() && jpeg[at] == '\xff' && jpeg[at + 1] != '\xda') {
    if (jpeg[at + 1] == '\xff') {  // a fill byte
      ++at;
      continue;
    }
    const std::size_t length = 2 + (static_cast<std::size_t>(static_cast<unsigned char>(jpeg[at + 2])) << 8 |
                                    static_cast<unsigned char>(jpeg[at + 3]));
    if (at + length > jpeg.size()) return jpeg;
    if (jpeg[at + 1] != '\xe1') out += jpeg.substr(at, length);
    at += length;
  }
  return out + jpeg.substr(at);
}

}  // namespace

std::string fill_page(const std::string& page,
                      const std::vector<std::pair<std::string, std::string>>& values) {
  std::string out;
  std::size_t at = 0;
  for (std::size_t open; (open = page.find("{{", at)) != std::string::npos;) {
    const std::size_t close = page.find("}}", open);
    const std::string name = page.substr(open + 2, close - open - 2);
    out += page.substr(at, open - at);
    for (const auto& [key, value] : values)
      if (key == name) out += value;
    at = close + 2;
  }
  return out + page.substr(at);
}

std::string html_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '&':
        out += "&amp;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string script_json(const std::string& json) {
  std::string out;
  for (const char c : json) c == '<' ? out += "\\u003c" : out += c;  // no "</script>" can end the element
  return out;
}

std::string base64(const std::string& bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      out += i + k <= bytes.size() ? kDigits[group >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

std::string picture_address(const Image& image, const std::string& bytes) {
  const bool is_jpeg = bytes.compare(0, 2, "\xff\xd8") == 0;
  if (is_jpeg && jpeg_orientation(bytes) != 1) return jpeg_address(image, kTurnedQuality);
  if (is_jpeg) return "data:image/jpeg;base64," + base64(without_exif(bytes));
  if (bytes.compare(1, 3, "PNG") == 0) return "data:image/png;base64," + base64(bytes);
  return png_address(image);
}

std::string png_address(const Image& image) {
  return "data:image/png;base64," + base64(encode_png(image));
}

std::string jpeg_address(const Image& image, int quality) {
  return "data:image/jpeg;base64," + base64(encode_jpeg(image, quality));
}

}  // namespace pliant::host
