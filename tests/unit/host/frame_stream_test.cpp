// The frames of a source: their numbers and times, and mirrored.
#include "host/commands/frame_stream.hpp"

#include <doctest/doctest.h>

#include "cli_run.hpp"
#include "host/commands/frame_reduction.hpp"
#include "host/io/failure.hpp"

namespace frame_stream_test {

using namespace pliant;
using namespace pliant::host;
using namespace cli_run;

namespace {

/// Three frames of 16 x 16 at 25 frames a second; pixel x of row 0 is 10 k + x in frame k.
std::string film() {
  std::string bytes = "YUV4MPEG2 W16 H16 F25:1 Cmono\n";
  for (int k = 0; k < 3; ++k) {
    bytes += "FRAME\n";
    for (int i = 0; i < 256; ++i) bytes += static_cast<char>(10 * k + i % 16);
  }
  return bytes;
}

}  // namespace

TEST_CASE("frames have numbers, and times from the first frame on") {
  const Folder folder;
  FrameStream frames(folder.put("v.y4m", film()), false);
  CHECK(frames.size().width == 16);
  CHECK(frames.rate().per_second() == 25);
  CHECK_FALSE(frames.is_live());
  FrameView frame;
  for (std::size_t k = 0; k < 3; ++k) {
    REQUIRE(frames.next(&frame));
    CHECK(frames.number(frame) == k);
    CHECK(frames.time_s(frame) == doctest::Approx(0.04 * static_cast<double>(k)));
    CHECK(frame.data[3] == 10 * k + 3);
  }
  CHECK_FALSE(frames.next(&frame));
  CHECK(frames.message().empty());
}

TEST_CASE("mirrored frames have their columns in reverse") {
  const Folder folder;
  FrameStream frames(folder.put("v.y4m", film()), true);
  FrameView frame;
  for (int k = 0; k < 3; ++k) {
    REQUIRE(frames.next(&frame));
    CHECK(frame.width == 16);
    for (int x = 0; x < 16; ++x) CHECK(frame.data[x] == 10 * k + 15 - x);
  }
}

TEST_CASE("a source that does not exist is a failure that names it") {
  const Folder folder;
  CHECK_THROWS_WITH_AS(FrameStream(folder / "none.y4m", false), doctest::Contains("none.y4m"), Failure);
}

TEST_CASE("the picture of a frame is the frame, mirrored as it is, and in colour if the source is") {
  const Folder folder;
  FrameView frame;
  FrameStream grey(folder.put("v.y4m", film()), true);
  REQUIRE(grey.next(&frame));
  CHECK(grey.picture(frame).channels == 1);
  CHECK(*grey.picture(frame).at(0, 0) == 15);
  Image colour(16, 16, 3);
  colour.at(15, 2)[2] = 99;
  FrameStream mirrored(folder.put("p.png", encode_png(colour)), true);
  REQUIRE(mirrored.next(&frame));
  CHECK(mirrored.picture(frame).at(0, 2)[2] == 99);
}

TEST_CASE("a reduced frame has the mean of each block, and places and cameras go there and back") {
  Image image(7, 5, 1);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<std::uint8_t>(3 * i);
  FrameView frame = frame_of(image, 4);
  FrameReduction by(2);
  const FrameView small = by.reduced(frame);
  CHECK(small.width == 3);
  CHECK(small.height == 2);
  CHECK(small.sequence == 4);
  CHECK(small.time_ns == frame.time_ns);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x) {
      const int first = 3 * (14 * y + 2 * x);  // the mean of it and those 3, 21 and 24 grey levels above
      CHECK(small.data[static_cast<std::size_t>(y) * small.stride_bytes + static_cast<std::size_t>(x)] ==
            first + 12);
    }
  // The middle of the first block of 2 x 2 pixels lies at half a pixel.
  CHECK(by.reduced(Vec2{0.5f, 2.5f}).x == 0);
  CHECK(by.reduced(Vec2{0.5f, 2.5f}).y == 1);
  CHECK(by.whole({0, 1}).y == 2.5f);
  const Camera camera = by.reduced(Camera{100, 3.5f, 2.5f});
  CHECK(camera.f == 50);
  CHECK(camera.cx == 1.5f);
  FrameReduction none;
  CHECK(none.reduced(frame).data == frame.data);
  const ImageSize large{3840, 2160};
  CHECK(FrameReduction::factor_for(3.0f, large) == 1);
  CHECK(FrameReduction::factor_for(9.0f, large) == 3);
  CHECK(FrameReduction::factor_for(1e30f, large) == 9);
  CHECK(FrameReduction::factor_for(-9.0f, large) == 1);
  CHECK(FrameReduction::factor_for(9.0f, {512, 512}) == 2);
  CHECK(FrameReduction::factor_for(9.0f, {100, 100}) == 1);
  CHECK(FrameReduction::factor_for(ImageSize{1280, 960}) == 1);
  CHECK(FrameReduction::factor_for(ImageSize{2160, 3840}) == 3);
  CHECK(FrameReduction::factor_for(ImageSize{16384, 100}) == 1);
}

}  // namespace frame_stream_test
