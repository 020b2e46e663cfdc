// Frames in colour, of streams and pictures.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "host/io/frame_source.hpp"
#include "host/io/image.hpp"
#include "scratch_folder.hpp"

namespace frame_colour_test {

using namespace pliant;
using namespace pliant::host;

TEST_CASE("a source with colour gives its last frame in colour, whatever the subsampling of chroma") {
  const Folder folder;
  // Two by two pixels of luma 100: a sample of chroma for each pixel, or one for all. Cb 128, Cr 128 is grey; Cr 228 is red.
  const std::string grey(4, 100), chroma_444{'\x80', '\x80', '\x80', '\x80', '\x80', '\xe4', '\x80', '\xe4'};
  const auto colour_of = [&](const char* space, const std::string& chroma) {
    const std::string path = folder.put(std::string(space) + ".y4m", std::string("YUV4MPEG2 W2 H2 F25:1 C") +
                                                                         space + "\nFRAME\n" + grey + chroma);
    const OpenedFrames opened = open_frames(path);
    REQUIRE(opened.source != nullptr);
    FrameView frame;
    REQUIRE(opened.source->next(frame) == Status::ok);
    return opened.source->colour().pixels;
  };
  CHECK(colour_of("mono", "").empty());
  const std::vector<std::uint8_t> red{240, 29, 100}, neutral{100, 100, 100};
  const auto one = colour_of("420jpeg", "\x80\xe4");
  REQUIRE(one.size() == 12);
  for (std::size_t i = 0; i < 12; ++i) CHECK(one[i] == red[i % 3]);
  const auto two = colour_of("444", chroma_444);
  REQUIRE(two.size() == 12);
  for (std::size_t i = 0; i < 12; ++i) CHECK(two[i] == (i % 6 < 3 ? neutral : red)[i % 3]);

  const auto limited = colour_of("420jpeg XCOLORRANGE=LIMITED", "\x80\xd8");  // luma 97.8, Cr 228.2
  REQUIRE(limited.size() == 12);
  for (std::size_t i = 0; i < 12; ++i) CHECK(limited[i] == std::vector<std::uint8_t>{238, 27, 98}[i % 3]);

  Image picture(8, 8, 3, 10);
  picture.at(3, 3)[1] = 200;
  folder.put("p.png", encode_png(picture));
  const OpenedFrames png = open_frames(folder / "p.png");
  REQUIRE(png.source != nullptr);
  CHECK(png.source->colour().pixels == picture.pixels);
}

TEST_CASE("a sample of chroma belongs to the pixels that it was made of, for odd sizes too") {
  const struct {
    const char* space;
    int across, down;
  } kLayouts[] = {{"411", 4, 1}, {"422", 2, 1}, {"420jpeg", 2, 2}, {"444", 1, 1}};
  for (const auto& l : kLayouts)
    for (int width = 1; width <= 9; ++width) {
      CAPTURE(l.space);
      CAPTURE(width);
      constexpr int kHeight = 3;
      const int across = (width + l.across - 1) / l.across, down = (kHeight + l.down - 1) / l.down;
      std::string cb, cr;
      for (int k = 0; k < across * down; ++k) {
        cb += '\x80';
        cr += static_cast<char>(128 + k);  // red tells which sample it is
      }
      const Folder folder;
      const std::string path =
          folder.put("x.y4m", "YUV4MPEG2 W" + std::to_string(width) + " H3 F25:1 C" + l.space + "\nFRAME\n" +
                                  std::string(static_cast<std::size_t>(width * kHeight), 100) + cb + cr);
      const OpenedFrames opened = open_frames(path);
      REQUIRE(opened.source != nullptr);
      FrameView frame;
      REQUIRE(opened.source->next(frame) == Status::ok);
      const Image colour = opened.source->colour();
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < width; ++x) {
          const int sample = y / l.down * across + x / l.across;
          CHECK(static_cast<int>(colour.at(x, y)[0]) == 100 + (1402 * sample + 500) / 1000);
        }
    }
}

TEST_CASE("PPM pictures have colour, scaled as their luma is; PGM pictures have none") {
  const Folder folder;
  folder.put("1.ppm", "P6 2 1 255\n\xc8\x64\x32\x01\x02\x03");
  folder.put("2.pgm", "P5 2 1 255\n\x05\x06");
  folder.put("3.ppm", "P6 2 1 15\n\x0f\x01\x02\x03\x04\x05");
  const OpenedFrames opened = open_frames(folder.path.string());
  REQUIRE(opened.source != nullptr);
  FrameView frame;
  const std::vector<std::uint8_t> expected[] = {{200, 100, 50, 1, 2, 3}, {}, {255, 17, 34, 51, 68, 85}};
  for (const auto& pixels : expected) {
    REQUIRE(opened.source->next(frame) == Status::ok);
    CHECK(opened.source->colour().pixels == pixels);
  }
  CHECK(static_cast<int>(frame.data[1]) == 17 * luma(3, 4, 5));
}

}  // namespace frame_colour_test
