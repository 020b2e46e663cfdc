// Reads and writes picture files with stb, which only this file uses.
#include "host/io/failure.hpp"
#include "host/io/files.hpp"
#include "host/io/image.hpp"
#include "host/io/jpeg_orientation.hpp"
#include "host/io/jpeg_tables.hpp"
#include "host/io/pnm.hpp"

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wdouble-promotion"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#endif
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_NO_HDR
#define STBI_NO_LINEAR
#define STBI_NO_STDIO
// The others have no safe mark at their beginning, or go on reading behind the end of a file that is cut off.
#define STBI_ONLY_JPEG
#define STBI_ONLY_PNG
#define STBI_ONLY_PNM
#include <stb_image.h>
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#include <stb_image_write.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

namespace pliant::host {

namespace {

/// Bounds memory and time, to 300 MB and some seconds.
constexpr std::int64_t kMostPixels = 100'000'000;

/// Why stb could not read a picture; it does not always say.
std::string reason() {
  const char* why = stbi_failure_reason();
  return why != nullptr && *why != '\0' ? why : "its data are cut off";
}

void append(void* context, void* data, int size) {
  static_cast<std::string*>(context)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
}

}  // namespace

Image read_image(const std::string& path) {
  return image_in(path, read_file(path));
}

Image image_in(const std::string& path, const std::string& bytes) {
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  const int length = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  if (!has_sound_huffman_tables(bytes))
    fail_input(path, "a damaged picture: a Huffman table of more than 256 codes");
  if (stbi_info_from_memory(data, length, &width, &height, &channels) == 0)
    fail_input(path, "is not a picture that is read (PNG, JPEG, PGM, PPM): " + reason());
  if (width > 16384 || height > 16384) fail_input(path, "is larger than 16384 pixels on a side");
  if (std::int64_t{width} * height > kMostPixels) fail_input(path, "has more than 100 million pixels");
  // stb takes every value of such a picture as one of 255, reads past the end where values have more than 8 bits, and takes a
  // comment behind the largest value for pixels.
  if (bytes[0] == 'P') {
    std::string wrong;
    Image picture = pnm_in(bytes, wrong);
    if (!wrong.empty()) fail_input(path, wrong);
    return picture;
  }
  unsigned char* pixels = stbi_load_from_memory(data, length, &width, &height, &channels, 3);
  if (pixels == nullptr) fail_input(path, "a damaged picture: " + reason());
  Image image(width, height, 3);
  image.pixels.assign(pixels, pixels + image.pixels.size());
  stbi_image_free(pixels);
  return upright(image, jpeg_orientation(bytes));
}

std::string encode_png(const Image& image) {
  std::string bytes;
  const int done = stbi_write_png_to_func(append, &bytes, image.width, image.height, image.channels,
                                          image.pixels.data(), image.width * image.channels);
  if (done == 0) throw Failure(kBadInput, "a picture of this size cannot be written");
  return bytes;
}

std::string encode_jpeg(const Image& image, int quality) {
  std::string bytes;
  const int done = stbi_write_jpg_to_func(append, &bytes, image.width, image.height, image.channels,
                                          image.pixels.data(), quality);
  if (done == 0) throw Failure(kBadInput, "a picture of this size cannot be written");
  return bytes;
}

}  // namespace pliant::host
