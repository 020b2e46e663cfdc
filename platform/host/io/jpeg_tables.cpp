#include "host/io/jpeg_tables.hpp"

namespace pliant::host {

namespace {

constexpr std::size_t kLengths = 16, kMostCodes = 256;
constexpr unsigned kRestart0 = 0xD0, kEnd = 0xD9, kHuffman = 0xC4;

/// Bytes one after the other. Behind the end all are 0, as stb reads them.
struct Bytes {
  std::string_view all;
  std::size_t at = 0;

  bool is_at_end() const { return at >= all.size(); }
  unsigned next() { return is_at_end() ? 0 : static_cast<unsigned char>(all[at++]); }
  std::size_t next_length() {
    const unsigned high = next();
    return 256 * high + next();
  }
};

/// The next marker that has a length, in tables and in the bits of the picture alike; kEnd behind the last one.
unsigned next_marker(Bytes& bytes) {
  while (!bytes.is_at_end()) {
    if (bytes.next() != 0xFF) continue;
    unsigned marker = 0xFF;
    while (marker == 0xFF && !bytes.is_at_end()) marker = bytes.next();
    const bool has_length = marker > 1 && !(marker >= kRestart0 && marker < kEnd);
    if (has_length) return marker;
  }
  return kEnd;
}

/// The tables of a segment, as far as its length says.
bool are_sound(Bytes segment, std::size_t length) {
  while (length > 0) {
    segment.next();  // which table
    std::size_t codes = 0;
    for (std::size_t k = 0; k < kLengths; ++k) codes += segment.next();
    if (codes > kMostCodes) return false;
    segment.at += codes;
    const std::size_t table = 1 + kLengths + codes;
    length -= table < length ? table : length;
  }
  return true;
}

}  // namespace

bool has_sound_huffman_tables(std::string_view jpeg) {
  Bytes bytes{jpeg};
  if (bytes.next() != 0xFF) return true;
  bytes.at = 0;
  for (unsigned marker = next_marker(bytes); marker != kEnd; marker = next_marker(bytes)) {
    const std::size_t begin = bytes.at, length = bytes.next_length();
    if (marker == kHuffman && length > 2 && !are_sound(bytes, length - 2)) return false;
    bytes.at = begin + (length > 2 ? length : 2);
  }
  return true;
}

}  // namespace pliant::host
