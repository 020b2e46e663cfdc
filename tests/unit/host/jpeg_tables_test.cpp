// JPEG files whose Huffman tables list more codes than there are: they must not reach stb_image.
#include "host/io/jpeg_tables.hpp"

#include <doctest/doctest.h>

#include <string>

#include "host/io/failure.hpp"
#include "host/io/image.hpp"
#include "scratch_folder.hpp"

namespace jpeg_tables_test {

using namespace pliant::host;

namespace {

std::string picture() {
  Image image(40, 30, 3, 90);
  for (std::size_t k = 0; k < image.pixels.size(); k += 7) image.pixels[k] = static_cast<unsigned char>(k);
  return encode_jpeg(image, 90);
}

/// A segment with Huffman tables, one after the other, whose codes all have 5 to 8 bits. \param codes  of each.
std::string tables(std::initializer_list<int> codes) {
  std::string all;
  for (int left : codes) {
    std::string counts(16, '\0');
    for (std::size_t k = 4; k < 8; ++k) {
      counts[k] = static_cast<char>(left < 255 ? left : 255);
      left -= static_cast<unsigned char>(counts[k]);
    }
    REQUIRE(left == 0);
    std::size_t values = 0;
    for (const char c : counts) values += static_cast<unsigned char>(c);
    all += '\0' + counts + std::string(values, 'v');
  }
  const std::size_t length = all.size() + 2;
  return std::string("\xFF\xC4") + static_cast<char>(length >> 8) + static_cast<char>(length & 255) + all;
}

const std::string kBegin = "\xFF\xD8", kEnd = "\xFF\xD9";

}  // namespace

TEST_CASE("pictures of every kind pass, and pass however much of them is there") {
  const std::string jpeg = picture();
  for (std::size_t n = 0; n <= jpeg.size(); n += 3) CHECK(has_sound_huffman_tables(jpeg.substr(0, n)));
  CHECK(has_sound_huffman_tables(encode_png(Image(9, 9, 3, 1))));
  CHECK(has_sound_huffman_tables(std::string("P5 1 1 255 x")));
}

TEST_CASE("a table may list 256 codes and no more, wherever it stands") {
  CHECK(has_sound_huffman_tables(kBegin + tables({256}) + kEnd));
  CHECK_FALSE(has_sound_huffman_tables(kBegin + tables({257}) + kEnd));
  CHECK_FALSE(has_sound_huffman_tables(kBegin + tables({12, 1000}) + kEnd));
  CHECK_FALSE(has_sound_huffman_tables(kBegin + tables({12}) + tables({1000}) + kEnd));
  const std::string jpeg = picture();
  CHECK_FALSE(has_sound_huffman_tables(jpeg.substr(0, jpeg.size() - 2) + tables({300}) + kEnd));
  CHECK_FALSE(has_sound_huffman_tables(kBegin + "something\xFF" + tables({300})));
  CHECK_FALSE(has_sound_huffman_tables(kBegin + tables({300}).substr(0, 21)));
}

TEST_CASE(
    "what looks like a table is none within another segment, between bits of the picture, and behind its "
    "end") {
  const std::string looks = tables({300});
  const auto length = static_cast<char>(looks.size() & 255);
  const auto high = static_cast<char>(looks.size() >> 8);
  CHECK(has_sound_huffman_tables(kBegin + "\xFF\xE1" + high + length + looks.substr(2) + looks.substr(0, 2) +
                                 kEnd));
  CHECK(has_sound_huffman_tables(kBegin + kEnd + looks));
  std::string bits = looks;
  bits.insert(1, 1, '\0');  // FF in the bits of a picture
  CHECK(has_sound_huffman_tables(kBegin + bits + kEnd));
}

TEST_CASE("such a file is refused by name before it is decoded") {
  const Folder folder;
  const std::string path = folder.put("bad.jpg", kBegin + tables({1000}) + kEnd);
  std::string message;
  try {
    read_image(path);
  } catch (const Failure& failure) {
    message = failure.what();
  }
  CHECK(message.find("bad.jpg") != std::string::npos);
  CHECK(message.find("Huffman") != std::string::npos);
}

}  // namespace jpeg_tables_test
