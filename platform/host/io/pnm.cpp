#include "host/io/pnm.hpp"

#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "host/io/sources.hpp"

namespace pliant::host {
namespace {

struct Close {
  void operator()(std::FILE* f) const { std::fclose(f); }
};
using File = std::unique_ptr<std::FILE, Close>;

struct Header {
  int channels = 0, width = 0, height = 0, maximum = 0;
};

// The next character of a header that is not white space. Comments run from # to the end of the line.
int skip_to_token(std::FILE* f) {
  int c = std::fgetc(f);
  while (c == '#' || std::isspace(c) != 0) {
    if (c == '#')
      while (c != '\n' && c != '\r' && c != EOF) c = std::fgetc(f);
    c = std::fgetc(f);
  }
  return c;
}

// The end of a comment that begins directly behind a number: its line's end does not separate the two, white space behind it does
// (the specification). Many programs take the line's end for that; so do we where no white space is.
int skip_comments(std::FILE* f, int c) {
  while (c == '#') {
    while (c != '\n' && c != '\r' && c != EOF) c = std::fgetc(f);
    if (c == EOF) return EOF;
    c = std::fgetc(f);
  }
  if (std::isspace(c) != 0) return c;
  std::ungetc(c, f);
  return '\n';
}

// Reads a number and the white space after it; -1 if there is none or it is too large.
int read_number(std::FILE* f) {
  int c = skip_to_token(f), value = 0;
  if (std::isdigit(c) == 0) return -1;
  for (; std::isdigit(c) != 0; c = std::fgetc(f)) {
    value = 10 * value + (c - '0');
    if (value > 1000000) return -1;
  }
  if (c == '#') c = skip_comments(f, c);
  return c == EOF || std::isspace(c) != 0 ? value : -1;
}

// Returns the error; empty on success.
std::string read_header(std::FILE* f, Header& h) {
  const int p = std::fgetc(f), kind = std::fgetc(f);
  if (p != 'P' || kind < '1' || kind > '7') return "not a PGM or PPM picture";
  if (kind != '5' && kind != '6')
    return std::string("a P") + static_cast<char>(kind) +
           " picture; only binary PGM (P5) and PPM (P6) are read";
  h.channels = kind == '5' ? 1 : 3;
  h.width = read_number(f);
  h.height = read_number(f);
  h.maximum = read_number(f);
  if (h.width < 0 || h.height < 0 || h.maximum < 0) return "its header has no width, height and maximum";
  if (h.width < 1 || h.height < 1 || h.width > kMaxFrameSide || h.height > kMaxFrameSide)
    return "its header says " + std::to_string(h.width) + "x" + std::to_string(h.height) +
           ", but a side is 1 to " + std::to_string(kMaxFrameSide);
  if (h.maximum < 1 || h.maximum > 255)
    return "its largest value is " + std::to_string(h.maximum) + "; only 8-bit pictures are read";
  return {};
}

std::string early(std::size_t missing) {
  return "ends " + std::to_string(missing) + " bytes early";
}

// A value of a picture with this largest one, as one of 255.
std::uint8_t stretched(int value, int maximum) {
  const int v = value > maximum ? maximum : value;
  return static_cast<std::uint8_t>((v * 255 + maximum / 2) / maximum);
}

// One row of samples, as luma.
void to_luma(const std::uint8_t* row, const Header& h, std::uint8_t* out) {
  for (int x = 0; x < h.width; ++x, row += h.channels) {
    const int value = h.channels == 1 ? row[0] : luma(row[0], row[1], row[2]);
    out[x] = stretched(value, h.maximum);
  }
}

// Returns the error; empty on success.
std::string read_picture(std::FILE* f, LumaPicture& picture, Status& status) {
  status = Status::io_error;
  Header h;
  if (const std::string wrong = read_header(f, h); !wrong.empty()) return wrong;
  const auto width = static_cast<std::size_t>(h.width),
             row_bytes = width * static_cast<std::size_t>(h.channels);
  std::vector<std::uint8_t> row(row_bytes), pixels, colour;
  for (int y = 0; y < h.height; ++y) {
    const std::size_t got = std::fread(row.data(), 1, row_bytes, f);
    if (got < row_bytes) {
      status = Status::truncated;
      return early(row_bytes * static_cast<std::size_t>(h.height - y) - got);
    }
    pixels.resize(pixels.size() + width);
    to_luma(row.data(), h, pixels.data() + pixels.size() - width);
    for (std::size_t k = 0; h.channels == 3 && k < row_bytes; ++k)
      colour.push_back(stretched(row[k], h.maximum));
  }
  status = Status::ok;
  picture = {h.width, h.height, std::move(pixels), {}};
  if (h.channels != 3) return {};
  picture.colour.width = h.width;
  picture.colour.height = h.height;
  picture.colour.channels = h.channels;
  picture.colour.pixels = std::move(colour);
  return {};
}

}  // namespace

Image pnm_in(const std::string& bytes, std::string& message) {
  const File file(::fmemopen(const_cast<char*>(bytes.data()), bytes.size(), "rb"));
  LumaPicture picture;
  Status status;
  message = file ? read_picture(file.get(), picture, status) : "not a PGM or PPM picture";
  if (!message.empty() || !picture.colour.pixels.empty()) return picture.colour;
  Image grey(picture.width, picture.height, 1);
  grey.pixels = std::move(picture.pixels);
  return to_colour(grey);
}

Status read_pnm(const std::string& path, LumaPicture& picture, std::string& message) {
  const File file(std::fopen(path.c_str(), "rb"));
  if (!file) {
    message = path + ": " + std::strerror(errno);
    return Status::io_error;
  }
  Status status;
  const std::string wrong = read_picture(file.get(), picture, status);
  if (status != Status::ok) message = path + ": " + wrong;
  return status;
}

}  // namespace pliant::host
