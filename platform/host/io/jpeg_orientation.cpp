#include "host/io/jpeg_orientation.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace pliant::host {

namespace {

constexpr std::uint32_t kOrientationTag = 274, kShort = 3;
constexpr unsigned kExifMarker = 0xE1, kFirstScan = 0xDA;

unsigned byte_at(std::string_view bytes, std::size_t at) {
  return at < bytes.size() ? static_cast<unsigned char>(bytes[at]) : 0;
}

/// The TIFF structure in an Exif segment: numbers of either byte order.
struct Tiff {
  std::string_view bytes;
  bool is_little;

  std::uint32_t number(std::size_t at, std::size_t size) const {
    std::uint32_t value = 0;
    for (std::size_t k = 0; k < size; ++k)
      value = 256 * value + byte_at(bytes, at + (is_little ? size - 1 - k : k));
    return value;
  }
};

/// Of the first directory.
int orientation_of(std::string_view bytes) {
  const Tiff tiff{bytes, byte_at(bytes, 0) == 'I'};
  const std::size_t directory = tiff.number(4, 4);
  if (tiff.number(2, 2) != 42 || directory >= bytes.size()) return 1;
  const std::size_t count = tiff.number(directory, 2);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t entry = directory + 2 + 12 * k;
    if (entry + 12 > bytes.size()) return 1;
    if (tiff.number(entry, 2) != kOrientationTag || tiff.number(entry + 2, 2) != kShort) continue;
    const std::uint32_t value = tiff.number(entry + 8, 2);
    return value >= 1 && value <= 8 ? static_cast<int>(value) : 1;
  }
  return 1;
}

}  // namespace

int jpeg_orientation(std::string_view jpeg) {
  if (byte_at(jpeg, 0) != 0xFF || byte_at(jpeg, 1) != 0xD8) return 1;
  for (std::size_t at = 2; at + 4 <= jpeg.size() && byte_at(jpeg, at) == 0xFF;) {
    while (at + 4 < jpeg.size() && byte_at(jpeg, at + 1) == 0xFF) ++at;  // fill bytes (ISO 10918-1, B.1.1.2)
    const unsigned marker = byte_at(jpeg, at + 1);
    const std::size_t length = 256 * byte_at(jpeg, at + 2) + byte_at(jpeg, at + 3);
    if (marker == kFirstScan || length < 2) return 1;
    const std::string_view segment = jpeg.substr(at + 4, length - 2);
    constexpr std::string_view kExif("Exif\0\0", 6);
    if (marker == kExifMarker && segment.substr(0, kExif.size()) == kExif)
      return orientation_of(segment.substr(kExif.size()));
    at += 2 + length;
  }
  return 1;
}

Image upright(const Image& image, int orientation) {
  if (orientation <= 1 || orientation > 8) return image;
  // First rows and columns change places, where they do; then each is mirrored, where it is.
  const bool swaps = orientation >= 5;
  const bool mirrors_x = orientation == 2 || orientation == 3 || orientation == 6 || orientation == 7;
  const bool mirrors_y = orientation == 3 || orientation == 4 || orientation == 7 || orientation == 8;
  Image out(swaps ? image.height : image.width, swaps ? image.width : image.height, image.channels);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      const int u = mirrors_x ? out.width - 1 - x : x, v = mirrors_y ? out.height - 1 - y : y;
      std::copy_n(swaps ? image.at(v, u) : image.at(u, v), image.channels, out.at(x, y));
    }
  return out;
}

}  // namespace pliant::host
