// Pictures of cameras that were held otherwise: read as they are to be shown.
#include "host/io/jpeg_orientation.hpp"

#include <doctest/doctest.h>

#include <string>

#include "host/io/files.hpp"
#include "scratch_folder.hpp"

namespace jpeg_orientation_test {

using namespace pliant::host;

namespace {

/// An Exif segment with another tag and the orientation, in either byte order.
std::string exif(int orientation, bool is_little, int type = 3) {
  const auto number = [&](unsigned value, int bytes) {
    std::string out;
    for (int k = 0; k < bytes; ++k)
      out += static_cast<char>(value >> 8 * (is_little ? k : bytes - 1 - k) & 255);
    return out;
  };
  const auto entry = [&](unsigned tag, unsigned of_type, unsigned value) {
    return number(tag, 2) + number(of_type, 2) + number(1, 4) + number(value, 2) + number(0, 2);
  };
  const std::string tiff =
      std::string(is_little ? "II" : "MM") + number(42, 2) + number(8, 4) + number(2, 2) + entry(256, 3, 40) +
      entry(274, static_cast<unsigned>(type), static_cast<unsigned>(orientation)) + number(0, 4);
  const std::string body = std::string("Exif\0\0", 6) + tiff;
  const std::size_t length = body.size() + 2;
  return std::string("\xFF\xE1") + static_cast<char>(length >> 8) + static_cast<char>(length & 255) + body;
}

/// Two by three pixels, each of its own value.
Image numbered() {
  Image image(2, 3, 1);
  for (std::size_t k = 0; k < 6; ++k) image.pixels[k] = static_cast<std::uint8_t>(k);
  return image;
}

std::string with(const std::string& segment) {
  const std::string jpeg = encode_jpeg(Image(32, 16, 3, 90), 90);
  return jpeg.substr(0, 2) + segment + jpeg.substr(2);
}

}  // namespace

TEST_CASE("the eight orientations of the standard: where the picture's first row and column are shown") {
  // Rows of 2 by 3 pixels: 0 1, 2 3, 4 5.
  const std::vector<std::vector<std::uint8_t>> shown = {
      {0, 1, 2, 3, 4, 5}, {1, 0, 3, 2, 5, 4}, {5, 4, 3, 2, 1, 0}, {4, 5, 2, 3, 0, 1},   // 1 to 4: 2 by 3
      {0, 2, 4, 1, 3, 5}, {4, 2, 0, 5, 3, 1}, {5, 3, 1, 4, 2, 0}, {1, 3, 5, 0, 2, 4}};  // 5 to 8: 3 by 2
  for (int k = 1; k <= 8; ++k) {
    CAPTURE(k);
    const Image image = upright(numbered(), k);
    CHECK(image.width == (k < 5 ? 2 : 3));
    CHECK(image.pixels == shown[static_cast<std::size_t>(k - 1)]);
  }
}

TEST_CASE("the orientation is read in both byte orders, and read_image turns the picture") {
  const Folder folder("orientation");
  for (const bool is_little : {false, true})
    for (int k = 1; k <= 8; ++k) {
      const std::string jpeg = with(exif(k, is_little));
      CHECK(jpeg_orientation(jpeg) == k);
      const std::string path = (folder.path / "picture.jpg").string();
      write_file(path, jpeg);
      CHECK(read_image(path).width == (k < 5 ? 32 : 16));
    }
}

TEST_CASE("what tells no orientation is upright: other files, other tags, values out of range, cut ends") {
  CHECK(jpeg_orientation("") == 1);
  CHECK(jpeg_orientation("\xFF") == 1);
  CHECK(jpeg_orientation(std::string("\x89PNG", 4)) == 1);
  CHECK(jpeg_orientation(with("")) == 1);
  for (const int value : {0, 9, 65535}) CHECK(jpeg_orientation(with(exif(value, true))) == 1);
  CHECK(jpeg_orientation(with(exif(6, true, 4))) == 1);
  CHECK(jpeg_orientation(with("\xFF\xFF" + exif(6, true))) == 6);  // fill bytes before the marker
  CHECK(jpeg_orientation(with("\xFF\xFF")) == 1);
  const std::string whole = with(exif(6, false));
  for (std::size_t n = 0; n < 60; ++n) {
    const int k = jpeg_orientation(whole.substr(0, n));
    CHECK((k == 1 || k == 6));
  }
}

}  // namespace jpeg_orientation_test
